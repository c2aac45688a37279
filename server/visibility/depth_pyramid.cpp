#include "server/visibility/depth_pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "common/check.hpp"

namespace iwalk {
namespace {

// The farthest of 2 x 2 squares; a last row or column without a partner stands twice. Plain loops: compilers
// make vectors of them.
void halve(const float* from, int width, int height, float* to, int toWidth, std::vector<float>& row) {
    row.resize(static_cast<std::size_t>(2 * toWidth));
    for (int y = 0; y < height; y += 2) {
        const float* upper = from + std::ptrdiff_t{y} * width;
        const float* lower = y + 1 < height ? upper + width : upper;
        float* both = row.data();
        for (int x = 0; x < width; ++x) both[x] = std::min(upper[x], lower[x]);
        if (width & 1) both[width] = both[width - 1];
        float* out = to + std::ptrdiff_t{y / 2} * toWidth;
        for (int x = 0; x < toWidth; ++x) out[x] = std::min(both[2 * x], both[2 * x + 1]);
    }
}

}  // namespace

void DepthPyramid::build(std::span<const float> depths, int width, int height) {
    CHECK_OP(depths.size(), >=, static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const int levels = 1 + std::bit_width(static_cast<unsigned>(std::max({width, height, 1}) - 1));
    levels_.resize(static_cast<std::size_t>(levels));
    std::vector<float> row;
    const float* from = depths.data();
    for (Level& level : levels_) {
        const bool finest = &level == levels_.data();
        level.width = finest ? width : (width + 1) / 2;
        level.height = finest ? height : (height + 1) / 2;
        level.farthest.resize(static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height));
        if (finest)
            std::copy_n(from, level.farthest.size(), level.farthest.data());
        else
            halve(from, width, height, level.farthest.data(), level.width, row);
        from = level.farthest.data();
        width = level.width;
        height = level.height;
    }
}

bool DepthPyramid::hides(const ScreenBox& box) const {
    if (box.empty()) return true;
    // Begin with squares as large as the box: at most four of them.
    const int edge = std::max(box.right - box.left, box.bottom - box.top);
    const int level = std::bit_width(static_cast<unsigned>(edge - 1));
    return hides(box, std::min(level, static_cast<int>(levels_.size()) - 1));
}

double DepthPyramid::openPixels(const ScreenBox& box) const {
    if (box.empty()) return 0;
    constexpr int kRows = 16;
    const Level& pixels = levels_.front();
    const int height = box.bottom - box.top, apart = (height + kRows - 1) / kRows;
    int open = 0, rows = 0;
    for (int y = box.top + (apart - 1) / 2; y < box.bottom; y += apart, ++rows) {
        const float* row = pixels.farthest.data() + std::ptrdiff_t{y} * pixels.width;
        for (int x = box.left; x < box.right; ++x) open += row[x] <= box.depth ? 1 : 0;
    }
    return static_cast<double>(open) * height / rows;
}

bool DepthPyramid::hides(const ScreenBox& box, int index) const {
    const Level& level = levels_[static_cast<std::size_t>(index)];
    const int size = 1 << index;
    for (int y = box.top >> index; y <= (box.bottom - 1) >> index; ++y)
        for (int x = box.left >> index; x <= (box.right - 1) >> index; ++x) {
            if (level.farthest[static_cast<std::size_t>(y * level.width + x)] > box.depth) continue;
            if (index == 0) return false;
            const ScreenBox part{std::max(box.left, x * size), std::max(box.top, y * size),
                                 std::min(box.right, (x + 1) * size), std::min(box.bottom, (y + 1) * size),
                                 box.depth};
            if (!hides(part, index - 1)) return false;
        }
    return true;
}

}  // namespace iwalk
