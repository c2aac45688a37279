#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// Which tiles each rank draws, in the wall's order, given the ranks' host names; there are not more ranks
// than tiles. The tiles that name a host ('wall-1' is also 'wall-1.lab.org') are shared by the ranks there.
// The others are shared by the ranks that are left, or by all when none is. Shares are contiguous and as even
// as can be, and every rank has one. So a wall that names no hosts and has a rank for each tile has tile i on
// rank i.
Result<std::vector<std::vector<std::size_t>>> tilesOfRanks(const Wall& wall,
                                                           const std::vector<std::string>& hosts);

}  // namespace iwalk
