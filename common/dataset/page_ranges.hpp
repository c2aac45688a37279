#pragma once

#include <span>
#include <vector>

#include "common/dataset/page.hpp"

// Inside common/dataset only: the stream of a page's ranges.
namespace iwalk {

// In index order, covering all indices.
std::vector<std::byte> codeRanges(const std::vector<Range>& ranges);

// Ranges that follow one another, cover `record`'s indices, and have paths and boxes; or what is wrong.
Result<std::vector<Range>> decodeRanges(std::span<const std::byte> coded, const PageRecord& record);

}  // namespace iwalk
