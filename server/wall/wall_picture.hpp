#pragma once

#include <string>

#include "common/image.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// A wall's layout for people: tiles with their names, ranks, sizes and hosts (one colour a host), overlaps
// bright, bezels black. Free screens are seen from behind and above their eye.
ColorImage drawWall(const Wall& wall, int width, int height);

// The same in words: a line for the wall, for each free screen, and for each tile.
std::string describeWall(const Wall& wall);

}  // namespace iwalk
