#pragma once

#include <vector>

#include "common/protocol.hpp"

namespace iwalk::client {

// Where a tile is when the wall is drawn small: parts of its width and height, from 0 to 1.
struct PlaceOnWall {
    double x = 0, y = 0, width = 1, height = 1;
};
// The places of all tiles, and how much wider than high the whole is. Tiles of free screens, which have no
// common rectangle, stand in rows.
struct SmallWall {
    std::vector<PlaceOnWall> places;
    double aspect = 1;
};
SmallWall smallWall(const protocol::Welcome& welcome);

// Each tile's share of the time, and what is wrong with it, in the current window.
void drawWallMap(const protocol::Welcome& welcome, const protocol::FrameDone& frame);

}  // namespace iwalk::client
