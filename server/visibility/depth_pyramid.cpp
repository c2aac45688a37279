#include "server/visibility/depth_pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "common/check.hpp"

namespace iwalk {
namespace {

// The farthest of 2 x 2 squares, for rows [first, end) of the result; a last row or column without a partner
// stands twice. Plain loops: compilers make vectors of them.
void halve(const float* from, int width, int height, float* to, int first, int end) {
    const int toWidth = (width + 1) / 2;
    std::vector<float> row(static_cast<std::size_t>(2 * toWidth));
    for (int y = first; y < end; ++y) {
        const float* upper = from + std::ptrdiff_t{2 * y} * width;
        const float* lower = 2 * y + 1 < height ? upper + width : upper;
        float* both = row.data();
        for (int x = 0; x < width; ++x) both[x] = std::min(upper[x], lower[x]);
        if (width & 1) both[width] = both[width - 1];
        float* out = to + std::ptrdiff_t{y} * toWidth;
        for (int x = 0; x < toWidth; ++x) out[x] = std::min(both[2 * x], both[2 * x + 1]);
    }
}

constexpr std::size_t kTogether = 64;  // rows that a thread takes

}  // namespace

void DepthPyramid::build(std::vector<float>& depths, int width, int height, Workers& workers) {
    CHECK_OP(depths.size(), ==, static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const int levels = 1 + std::bit_width(static_cast<unsigned>(std::max({width, height, 1}) - 1));
    levels_.resize(static_cast<std::size_t>(levels));
    levels_.front().width = width, levels_.front().height = height;
    levels_.front().farthest.swap(depths);
    for (std::size_t i = 1; i < levels_.size(); ++i) {
        const Level& finer = levels_[i - 1];
        Level& level = levels_[i];
        level.width = (finer.width + 1) / 2;
        level.height = (finer.height + 1) / 2;
        const auto rows = static_cast<std::size_t>(level.height);
        level.farthest.resize(static_cast<std::size_t>(level.width) * rows);
        workers.runParts(rows, kTogether, [&](std::size_t first, std::size_t end) {
            halve(finer.farthest.data(), finer.width, finer.height, level.farthest.data(),
                  static_cast<int>(first), static_cast<int>(end));
        });
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
