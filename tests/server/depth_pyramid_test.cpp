#include "server/visibility/depth_pyramid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>

namespace iwalk {
namespace {

bool hidesByLooking(const std::vector<float>& depths, int width, const ScreenBox& box) {
    for (int y = box.top; y < box.bottom; ++y)
        for (int x = box.left; x < box.right; ++x)
            if (depths[static_cast<std::size_t>(y * width + x)] <= box.depth) return false;
    return true;
}

DepthPyramid pyramidOf(const std::vector<float>& depths, int width, int height) {
    DepthPyramid pyramid;
    pyramid.build(width, height, [&](int first, int rows, float* to) {
        std::copy_n(depths.begin() + std::ptrdiff_t{first} * width, std::ptrdiff_t{rows} * width, to);
    });
    return pyramid;
}

TEST(DepthPyramid, IsExactToThePixel) {
    std::mt19937 random(3);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    for (const auto& [width, height] : {std::pair(1, 1), {7, 3}, {64, 64}, {65, 33}, {3, 100}, {317, 211}}) {
        // Flat surfaces with a few holes and steps, so that either answer is frequent.
        std::vector<float> depths(static_cast<std::size_t>(width * height), 0.5f);
        for (int i = 0; i < width * height / 50; ++i)
            depths[random() % depths.size()] = static_cast<float>(below(5)) / 4;
        const DepthPyramid pyramid = pyramidOf(depths, width, height);
        int hidden = 0;
        for (int i = 0; i < 3000; ++i) {
            ScreenBox box;
            box.left = below(width), box.top = below(height);
            box.right = box.left + 1 + below(std::min(width - box.left, 1 + below(40)));
            box.bottom = box.top + 1 + below(std::min(height - box.top, 1 + below(40)));
            box.depth = static_cast<float>(below(9)) / 8;
            const bool hides = pyramid.hides(box);
            ASSERT_EQ(hides, hidesByLooking(depths, width, box));
            hidden += hides;
        }
        EXPECT_GT(hidden, 100);
        EXPECT_LT(hidden, 2900);
    }
}

TEST(DepthPyramid, ASurfaceAsNearAsTheBoxHidesNothing) {
    const DepthPyramid pyramid = pyramidOf(std::vector<float>(12, 0.25f), 4, 3);
    EXPECT_FALSE(pyramid.hides({1, 1, 3, 2, 0.25f}));
    EXPECT_TRUE(pyramid.hides({1, 1, 3, 2, std::nextafter(0.25f, 0.0f)}));
    EXPECT_FALSE(pyramid.hides({0, 0, 4, 3, ScreenBox::kAtTheEye}));
}

TEST(DepthPyramid, NothingHidesWhereNothingIsDrawn) {
    const DepthPyramid pyramid = pyramidOf(std::vector<float>(12, 0.0f), 4, 3);
    EXPECT_FALSE(pyramid.hides({0, 0, 1, 1, 0}));
    EXPECT_TRUE(pyramid.hides({2, 2, 2, 3, 1}));  // no pixel, nothing to be seen
}

TEST(DepthPyramid, OpenPixelsAreCounted) {
    std::vector<float> depths(20 * 40, 0.5f);
    for (std::size_t y = 0; y < 40; ++y) depths[20 * y + y % 20] = 0.25f;  // a pixel in each row
    const DepthPyramid pyramid = pyramidOf(depths, 20, 40);
    EXPECT_EQ(pyramid.openPixels({0, 0, 20, 16, 0.3f}), 16);  // few rows: exact
    EXPECT_EQ(pyramid.openPixels({0, 0, 20, 40, 0.3f}), 40);  // some of the rows stand for all
    EXPECT_EQ(pyramid.openPixels({0, 0, 20, 40, 0.1f}), 0);
    EXPECT_EQ(pyramid.openPixels({3, 5, 7, 38, ScreenBox::kAtTheEye}), 4 * 33);
    EXPECT_EQ(pyramid.openPixels({3, 5, 3, 38, 1}), 0);
}

}  // namespace
}  // namespace iwalk
