#pragma once

#include <string>

#include "common/image.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// Pictures by which a person hangs a wall:
//   grid      lines, circles and diagonals that go on from tile to tile, behind bezels and through overlaps;
//             single pixels in the middle of each tile
//   blend     bands of grey across the whole wall; projectors show them with their ramps, and the bands are
//   even
//             where these fit
//   identity  each tile's name, rank, host and size, and which way is up
enum class Pattern { none, grid, blend, identity };

// The server that draws a tile.
struct DrawnBy {
    int rank = 0, ranks = 1;
    std::string host;
};

// One tile's part.
ColorImage drawPattern(Pattern pattern, const Wall& wall, std::size_t tile, const DrawnBy& by);

}  // namespace iwalk
