#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// Which tile each rank draws, given the ranks' host names. A tile that names its host goes to the first free
// rank there ('wall-1' is also 'wall-1.lab.org'); the others go to the ranks that are left, both in their
// order. So a wall that names no hosts has tile i on rank i.
Result<std::vector<std::size_t>> tilesOfRanks(const Wall& wall, const std::vector<std::string>& hosts);

}  // namespace iwalk
