#include <gtest/gtest.h>

#include "preprocess/build/verify_nesting.hpp"
#include "preprocess/build/verify_targets.hpp"

namespace iwalk {
namespace {

TEST(TargetTableTest, PagesMustAgree) {
    TargetTable table(100);
    const LatticePoint a(1, 2, 3), b(4, 5, 6);
    EXPECT_TRUE(table.stays(0, a));
    EXPECT_TRUE(table.add(0, a, b));
    EXPECT_TRUE(table.add(0, a, b));
    EXPECT_TRUE(table.add(1, a, a));
    EXPECT_TRUE(table.add(0, b, b));
    EXPECT_FALSE(table.add(0, a, a));
    EXPECT_FALSE(table.add(1, a, b));
    EXPECT_FALSE(table.stays(0, a));
    EXPECT_TRUE(table.stays(1, a));
    EXPECT_TRUE(table.stays(0, b));
}

// A table of more than it has room for keeps a share of the positions, and more than was announced are no
// harm.
TEST(TargetTableTest, IsASampleOfMany) {
    TargetTable large(std::uint64_t{1} << 32), small(10);
    std::size_t found = 0;
    for (std::int64_t i = 0; i < 1'000'000; ++i) {
        large.add(0, LatticePoint(i, 0, 0), LatticePoint(0));
        found += large.add(0, LatticePoint(i, 0, 0), LatticePoint(1)) ? 0 : 1;
        EXPECT_TRUE(small.add(0, LatticePoint(i, 0, 0), LatticePoint(0)));
    }
    EXPECT_GT(found, 500u);
    EXPECT_LT(found, 2000u);
}

LatticeBox boxTo(std::int64_t edge) {
    return {LatticePoint(0), LatticePoint(edge)};
}

TEST(CoarseRangesTest, CellsContainCells) {
    EXPECT_EQ(CellPlace::of(5, 0b1'010), CellPlace::of(0b1'101'010));
    EXPECT_EQ(CellPlace::of(0, kRootPath), CellPlace::of(0b1'000));
    EXPECT_TRUE(CellPlace::of(kRootPath).contains(CellPlace::of(7, 0x7fffffff)));
    EXPECT_TRUE(CellPlace::of(0b1'101).contains(CellPlace::of(0b1'101'010)));
    EXPECT_FALSE(CellPlace::of(0b1'101'010).contains(CellPlace::of(0b1'101)));
    EXPECT_FALSE(CellPlace::of(0b1'100).contains(CellPlace::of(0b1'101'010)));
}

TEST(CoarseRangesTest, FinerRangesAreInTheDeepestThatContainsThem) {
    CoarseRanges ranges;
    ranges.add(CellPlace::of(0b1'001), boxTo(9));
    ranges.add(CellPlace::of(0b1'001'010), boxTo(5));
    ranges.add(CellPlace::of(0b1'100'000), boxTo(3));
    ranges.add(CellPlace::of(0b1'100'000), boxTo(7));
    const auto find = [&](std::uint32_t path, std::int64_t edge) {
        const CoarseRanges::Found found = ranges.find(CellPlace::of(path), boxTo(edge));
        return std::pair(found.contained, found.boxed);
    };
    EXPECT_EQ(find(0b1'001'111, 9), std::pair(true, true));
    EXPECT_EQ(find(0b1'001'010'000, 5), std::pair(true, true));
    EXPECT_EQ(find(0b1'001'010'000, 6), std::pair(true, false));
    EXPECT_EQ(find(0b1'100'000, 7), std::pair(true, true));  // in either of two
    EXPECT_EQ(find(0b1'100'000, 8), std::pair(true, false));
    EXPECT_EQ(find(0b1'010, 5), std::pair(false, true));  // in the one before
    EXPECT_EQ(find(0b1'010, 6), std::pair(false, false));
    EXPECT_EQ(find(0b1'000, 9), std::pair(false, true));  // in the first
    EXPECT_EQ(CoarseRanges().find(CellPlace::of(kRootPath), boxTo(1)).contained, false);
}

}  // namespace
}  // namespace iwalk
