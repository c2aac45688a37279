#pragma once

#include <vector>

#include "server/wall/wall.hpp"

namespace iwalk {

// Tiles are drawn in blocks of the screen: squares that begin at multiples of kBlockEdge px, or what of them
// lies in the tile. A rasteriser's interpolated depth depends, in its last bits, on where the framebuffer
// begins. Since it begins at the block's corner, whatever the tile, a pixel comes out the same however the
// screen is cut.
inline constexpr int kBlockEdge = 1024;
struct Block {
    int x = 0, y = 0;  // px of the screen: the corner that its framebuffer begins at
    PixelRect part;    // px of the screen: what is drawn
};
std::vector<Block> blocksOf(const PixelRect& tile);  // px of the screen
// The same from the tile's own corner: as few as can be, for pictures that depend on the tile anyway.
std::vector<Block> ownBlocksOf(const PixelRect& tile);

// The square of the screen that clip space spans while a block is drawn. Its edge is a power of two, so that
// transforms are exact. Screens wider than the largest viewport have a window for each strip of half that
// size; like blocks, strips belong to the screen and not to the tile.
struct Window {
    int x = 0, y = 0, edge = 0;  // px of the screen
};
Window windowFor(int screenWidth, int screenHeight, const Block& block);

}  // namespace iwalk
