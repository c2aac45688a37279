#include "server/visibility/depth_pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "common/check.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kLevelsTogether = 6;           // that are made of some rows
constexpr int kRowsTogether = 1 << kLevelsTogether;  // of pixels

// The farthest of 2 x 2 squares. A plain loop: compilers make vectors of it.
void halveRow(const float* upper, const float* lower, int squares, float* to) {
    for (int x = 0; x < squares; ++x)
        to[x] = std::min(std::min(upper[2 * x], upper[2 * x + 1]), std::min(lower[2 * x], lower[2 * x + 1]));
}

}  // namespace

void DepthPyramid::build(int width, int height, const ReadRows& read) {
    CHECK(width > 0 && height > 0);
    levels_.resize(
        1 + static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(std::max(width, height) - 1))));
    for (std::size_t i = 0; i < levels_.size(); ++i) {
        Level& level = levels_[i];
        level.width = i == 0 ? width : (levels_[i - 1].width + 1) / 2;
        level.height = i == 0 ? height : (levels_[i - 1].height + 1) / 2;
        level.farthest.resize(static_cast<std::size_t>(level.width) * static_cast<std::size_t>(level.height));
    }
    const std::size_t together = std::min(levels_.size(), kLevelsTogether + 1);
    for (int y = 0; y < height; y += kRowsTogether) {
        const int end = std::min(height, y + kRowsTogether);
        read(y, end - y, levels_.front().farthest.data() + std::ptrdiff_t{y} * width);
        for (std::size_t i = 1; i < together; ++i) halve(i, y >> i, ((end - 1) >> i) + 1);
    }
    for (std::size_t i = together; i < levels_.size(); ++i) halve(i, 0, levels_[i].height);
}

// Rows [first, end) of a level; a last row or column of the finer one without a partner stands twice.
void DepthPyramid::halve(std::size_t index, int first, int end) {
    const Level& finer = levels_[index - 1];
    Level& level = levels_[index];
    for (int y = first; y < end; ++y) {
        const float* upper = finer.farthest.data() + std::ptrdiff_t{2 * y} * finer.width;
        const float* lower = 2 * y + 1 < finer.height ? upper + finer.width : upper;
        float* to = level.farthest.data() + std::ptrdiff_t{y} * level.width;
        halveRow(upper, lower, finer.width / 2, to);
        if (finer.width & 1) to[level.width - 1] = std::min(upper[finer.width - 1], lower[finer.width - 1]);
    }
}

bool DepthPyramid::hides(const ScreenBox& box) const {
    if (box.empty()) return true;
    // Begin with squares as large as the box: at most four of them.
    const int edge = std::max(box.right - box.left, box.bottom - box.top);
    const int level = std::bit_width(static_cast<unsigned>(edge - 1));
    return hides(box, std::min(level, static_cast<int>(levels_.size()) - 1));
}

float DepthPyramid::openPixels(const ScreenBox& box) const {
    if (box.empty()) return 0;
    constexpr int kRows = 16;
    const Level& pixels = levels_.front();
    const int height = box.bottom - box.top, apart = (height + kRows - 1) / kRows;
    int open = 0, rows = 0;
    for (int y = box.top + (apart - 1) / 2; y < box.bottom; y += apart, ++rows) {
        const float* row = pixels.farthest.data() + std::ptrdiff_t{y} * pixels.width;
        for (int x = box.left; x < box.right; ++x) open += row[x] <= box.depth ? 1 : 0;
    }
    return static_cast<float>(open) * static_cast<float>(height) / static_cast<float>(rows);
}

bool DepthPyramid::hides(const ScreenBox& box, int index) const {
    const Level& level = levels_[static_cast<std::size_t>(index)];
    const int size = 1 << index;
    for (int y = box.top >> index; y <= (box.bottom - 1) >> index; ++y)
        for (int x = box.left >> index; x <= (box.right - 1) >> index; ++x) {
            if (level.farthest[static_cast<std::size_t>(y * level.width + x)] > box.depth) continue;
            const bool inside = x * size >= box.left && (x + 1) * size <= box.right && y * size >= box.top &&
                                (y + 1) * size <= box.bottom;
            if (inside) return false;  // the square's farthest pixel is one of the box
            const ScreenBox part{std::max(box.left, x * size), std::max(box.top, y * size),
                                 std::min(box.right, (x + 1) * size), std::min(box.bottom, (y + 1) * size),
                                 box.depth};
            if (!hides(part, index - 1)) return false;
        }
    return true;
}

}  // namespace iwalk
