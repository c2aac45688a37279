#include "server/draw/blocks.hpp"

#include <algorithm>
#include <bit>

namespace iwalk {
namespace {

constexpr int kMaxWindow = 16384;  // px: GL 4.5's least largest viewport
static_assert(kMaxWindow / 2 % kBlockEdge == 0);

// What of the tile lies in squares that begin at this corner.
std::vector<Block> squaresOf(const PixelRect& tile, int firstX, int firstY) {
    std::vector<Block> blocks;
    const int right = tile.x + tile.width, bottom = tile.y + tile.height;
    for (int y = firstY; y < bottom; y += kBlockEdge)
        for (int x = firstX; x < right; x += kBlockEdge) {
            const int left = std::max(x, tile.x), top = std::max(y, tile.y);
            const int width = std::min(x + kBlockEdge, right) - left,
                      height = std::min(y + kBlockEdge, bottom) - top;
            blocks.push_back({x, y, {left, top, width, height}});
        }
    return blocks;
}

}  // namespace

Window windowFor(int screenWidth, int screenHeight, const Block& block) {
    const int longest = std::max(screenWidth, screenHeight);
    const int edge = std::min(kMaxWindow, static_cast<int>(std::bit_ceil(static_cast<unsigned>(longest))));
    const int strip = edge / 2;
    const auto start = [&](int from, int screen) {
        return screen <= edge ? 0 : from / strip * strip - strip / 2;
    };
    return {start(block.x, screenWidth), start(block.y, screenHeight), edge};
}

std::vector<Block> blocksOf(const PixelRect& tile) {
    return squaresOf(tile, tile.x / kBlockEdge * kBlockEdge, tile.y / kBlockEdge * kBlockEdge);
}

std::vector<Block> ownBlocksOf(const PixelRect& tile) {
    return squaresOf(tile, tile.x, tile.y);
}

}  // namespace iwalk
