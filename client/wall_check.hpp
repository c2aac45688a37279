#pragma once

#include "common/protocol.hpp"
#include "common/result.hpp"

namespace iwalk::client {

// Whether what the server says of its wall can be trusted with file names and pixels: at least one tile;
// names of [A-Za-z0-9_.-] that do not begin with '.', all different, none "wall"; rectangles inside the wall
// (unless the wall is 0 x 0); a wall of at most 2^30 pixels, since it is stitched in memory.
Result<void> checkWall(const protocol::Welcome& welcome);

}  // namespace iwalk::client
