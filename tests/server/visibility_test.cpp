#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "server/visibility/frustum_visibility.hpp"
#include "tests/common/dataset_fixture.hpp"

namespace iwalk {
namespace {

using Ranges = std::array<std::uint32_t, 3>;  // page, first, count

// What is seen of the half space x >= `from` when the model is drawn at `level`, in the order it is drawn.
std::vector<Ranges> seen(unsigned level, double from, std::int64_t eyeX = 0) {
    const Hierarchy hierarchy = makeHierarchy();
    const LatticeEye eye{LatticePoint(eyeX, 0, 0), glm::dvec3(0)};
    Frustum frustum{};
    frustum.forward = glm::dvec3(1, 0, 0);
    frustum.near = from - static_cast<double>(eyeX);
    std::vector<Ranges> result;
    for (const VisibleRanges& ranges :
         FrustumVisibility(hierarchy).visible(cutAtLevel(hierarchy, level), frustum, eye)) {
        result.push_back({ranges.page, ranges.firstRange, ranges.rangeCount});
    }
    return result;
}

std::vector<Ranges> sorted(std::vector<Ranges> ranges) {
    std::ranges::sort(ranges);
    return ranges;
}

TEST(FrustumVisibilityTest, DrawsTheEntriesOfTheCut) {
    const double all = -1000;
    EXPECT_EQ(sorted(seen(0, all)), (std::vector<Ranges>{{0, 0, 2}}));
    EXPECT_EQ(sorted(seen(1, all)), (std::vector<Ranges>{{1, 0, 1}, {1, 1, 1}, {1, 2, 2}, {4, 0, 1}}));
    EXPECT_EQ(sorted(seen(kFullLevel, all)),
              (std::vector<Ranges>{{3, 0, 1}, {3, 1, 1}, {4, 0, 1}, {5, 0, 2}, {6, 0, 1}}));
}

// What stands for all below a node is seen where any of it may be; own triangles where they are.
TEST(FrustumVisibilityTest, EveryEntryHasItsBox) {
    EXPECT_EQ(seen(0, 92), (std::vector<Ranges>{{0, 0, 2}}));
    EXPECT_EQ(seen(0, 96), std::vector<Ranges>{});
    EXPECT_EQ(seen(1, 92), std::vector<Ranges>{});
    EXPECT_EQ(seen(1, 80), (std::vector<Ranges>{{1, 2, 2}}));
    EXPECT_EQ(sorted(seen(kFullLevel, 60)), (std::vector<Ranges>{{3, 0, 1}, {5, 0, 2}, {6, 0, 1}}));
}

// Page 3 has the root's own triangles and leaf 1: the box is of both.
TEST(FrustumVisibilityTest, PagesComeByTheDistanceOfAllTheyHave) {
    EXPECT_EQ(seen(kFullLevel, -1000, 200),
              (std::vector<Ranges>{{5, 0, 2}, {6, 0, 1}, {3, 0, 1}, {3, 1, 1}, {4, 0, 1}}));
    EXPECT_EQ(seen(kFullLevel, -1000, -200),
              (std::vector<Ranges>{{3, 0, 1}, {3, 1, 1}, {4, 0, 1}, {5, 0, 2}, {6, 0, 1}}));
}

}  // namespace
}  // namespace iwalk
