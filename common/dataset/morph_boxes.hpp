#pragma once

#include <span>
#include <vector>

#include "common/dataset/morph.hpp"

// Inside common/dataset only: the stream of a morph block's boxes. `origin`: the block's.
namespace iwalk {

std::vector<std::byte> codeMorphBoxes(const MorphSource& page, const LatticePoint& origin);

// Boxes of the ranges of the page that `table` is of; or what is wrong.
Result<std::vector<MorphBox>> decodeMorphBoxes(std::span<const std::byte> coded, const PageTable& table,
                                               const LatticePoint& origin);

}  // namespace iwalk
