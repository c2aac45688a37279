#include "tests/tools/compare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/tools/compare_limits.hpp"
#include "tests/tools/compare_report.hpp"
#include "tests/tools/window_range.hpp"

namespace iwalk::tools {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr float kInfinite = std::numeric_limits<float>::infinity();

// All grey, at depth 10.
Picture greyWall(int width, int height) {
    Picture picture{ColorImage(width, height, 3), DepthImage(width, height, 1)};
    for (auto& value : picture.color.pixels) value = 100;
    for (float& z : picture.depth.pixels) z = 10;
    return picture;
}

Comparison compareWithin(const Picture& reference, const Picture& test, double tolerance, double slack = 0) {
    return compare(reference, test, RangeOptions{tolerance, slack});
}

TEST(Compare, EqualPicturesDifferInNothing) {
    const Picture wall = greyWall(7, 5);
    const Comparison same = compare(wall, wall, RangeOptions{});
    EXPECT_EQ(same.pixels(), 35u);
    EXPECT_EQ(same.different, 0u);
    EXPECT_EQ(same.color.different, 0u);
    EXPECT_EQ(same.color.largestDifference, 0);
    EXPECT_TRUE(std::isinf(same.color.psnrDb));
    EXPECT_FALSE(same.color.firstDifferent);
    EXPECT_EQ(same.depth->different + same.depth->ties, 0u);
    EXPECT_EQ(same.range->outside + same.range->seeThrough, 0u);
}

TEST(Compare, ColorsAreCountedByPixel) {
    const Picture reference = greyWall(4, 4);
    Picture test = reference;
    test.color.at(2, 1)[0] = 103;  // two channels of one pixel
    test.color.at(2, 1)[2] = 96;
    test.color.at(0, 3)[1] = 101;
    const Comparison comparison = compare(reference, test, std::nullopt);
    EXPECT_EQ(comparison.color.different, 2u);
    EXPECT_EQ(comparison.color.largestDifference, 4);
    EXPECT_EQ(comparison.color.firstDifferent, (Pixel{2, 1}));
    // Squares 9 + 16 + 1 over 48 samples.
    EXPECT_DOUBLE_EQ(comparison.color.psnrDb, 10 * std::log10(255.0 * 255.0 * 48 / 26));
    EXPECT_FALSE(comparison.range);
}

TEST(Compare, DepthIsComparedByBitsAndTiesAreEqualDepthsOfOtherColor) {
    const Picture reference = greyWall(4, 1);
    Picture test = reference;
    test.depth.pixels[0] = std::nextafter(10.0f, 11.0f);    // depth only
    test.depth.pixels[1] = 11, test.color.at(1, 0)[0] = 0;  // both
    test.color.at(2, 0)[0] = 0;                             // colour only: a tie
    const Comparison comparison = compare(reference, test, std::nullopt);
    EXPECT_EQ(comparison.depth->different, 2u);
    EXPECT_EQ(comparison.depth->ties, 1u);
    EXPECT_EQ(comparison.color.different, 2u);
    EXPECT_EQ(comparison.different, 3u);
}

TEST(Compare, WithoutDepthOnlyColorsCount) {
    const Picture reference = greyWall(2, 2);
    const Picture test{reference.color, {}};
    const Comparison comparison = compare(reference, test, std::nullopt);
    EXPECT_FALSE(comparison.depth);
    EXPECT_EQ(comparison.different, 0u);
}

// A box at depth 4 before a wall at depth 10, and no surface to the right.
Picture boxBeforeWall() {
    Picture picture = greyWall(12, 9);
    for (int y = 0; y < 9; ++y) {
        for (int x = 0; x < 12; ++x) {
            if (x >= 2 && x < 5 && y >= 2 && y < 5) *picture.depth.at(x, y) = 4;
            if (x >= 9) *picture.depth.at(x, y) = 0;
        }
    }
    return picture;
}

TEST(Compare, ASurfaceDisplacedWithinTheToleranceIsInside) {
    const Picture reference = boxBeforeWall();
    Picture test = greyWall(12, 9);
    // The box one pixel to the right and down, the wall one pixel wider.
    for (int y = 0; y < 9; ++y) {
        for (int x = 0; x < 12; ++x) {
            if (x >= 3 && x < 6 && y >= 3 && y < 6) *test.depth.at(x, y) = 4;
            if (x >= 10) *test.depth.at(x, y) = 0;
        }
    }
    EXPECT_EQ(compareWithin(reference, test, 1).range->outside, 0u);
    EXPECT_EQ(compareWithin(reference, test, 0.25).range->outside, 0u);  // rounded up to a pixel
    EXPECT_EQ(compareWithin(reference, test, 0.25).range->windowPx, 3);
    // Without tolerance: 5 pixels of the box are uncovered and 5 newly covered, 9 of the wall are new.
    const RangeMeasures exact = *compareWithin(reference, test, 0).range;
    EXPECT_EQ(exact.outside, 19u);
    EXPECT_EQ(exact.seeThrough, 5u);
    EXPECT_EQ(exact.firstOutside, (Pixel{9, 0}));
}

TEST(Compare, HolesAndMissingPartsAreSeeThrough) {
    const Picture reference = boxBeforeWall();
    Picture test = reference;
    *test.depth.at(7, 7) = 0;   // a hole in the wall: the background shows
    *test.depth.at(3, 3) = 10;  // a hole in the box: the wall shows; the window of 3 x 3 sees only the box
    *test.depth.at(6, 0) = 9;   // nearer than anything around
    *test.depth.at(10, 4) = 5;  // a surface where there is none
    *test.depth.at(9, 4) = 0;   // no surface beside the wall's end: as it should be
    const RangeMeasures range = *compareWithin(reference, test, 1).range;
    EXPECT_EQ(range.outside, 4u);
    EXPECT_EQ(range.seeThrough, 2u);
    // Two pixels away there is the wall for the box, the background for the wall, and the box for the third.
    EXPECT_EQ(compareWithin(reference, test, 2).range->outside, 1u);
    EXPECT_EQ(compareWithin(reference, test, 2).range->seeThrough, 0u);
    EXPECT_EQ(compareWithin(reference, test, 2).range->firstOutside, (Pixel{10, 4}));
}

TEST(Compare, SlackWidensTheRangeByAShareOfItsDepth) {
    const Picture reference = greyWall(2, 1);
    Picture test = reference;
    test.depth.pixels = {10.05f, 9.95f};
    EXPECT_EQ(compareWithin(reference, test, 0).range->outside, 2u);
    EXPECT_EQ(compareWithin(reference, test, 0).range->seeThrough, 1u);
    EXPECT_EQ(compareWithin(reference, test, 0, 0.004).range->outside, 2u);
    EXPECT_EQ(compareWithin(reference, test, 0, 0.006).range->outside, 0u);
}

TEST(WindowRange, EqualsTheLoopOverEveryWindow) {
    std::mt19937 random(4);
    for (int reach : {0, 1, 2, 5, 30}) {
        DepthImage depth(17, 11, 1);
        for (float& z : depth.pixels) z = static_cast<float>(random() % 50);
        const WindowRange window = windowRange(depth, reach);
        for (int y = 0; y < depth.height; ++y) {
            for (int x = 0; x < depth.width; ++x) {
                float least = kInfinite, greatest = 0;
                for (int v = std::max(0, y - reach); v <= std::min(depth.height - 1, y + reach); ++v) {
                    for (int u = std::max(0, x - reach); u <= std::min(depth.width - 1, x + reach); ++u) {
                        least = std::min(least, asDistance(*depth.at(u, v)));
                        greatest = std::max(greatest, asDistance(*depth.at(u, v)));
                    }
                }
                ASSERT_EQ(*window.nearest.at(x, y), least) << reach << " at " << x << ", " << y;
                ASSERT_EQ(*window.farthest.at(x, y), greatest) << reach << " at " << x << ", " << y;
            }
        }
    }
}

TEST(Limits, AreNumbersOfPixelsOrSharesOfThem) {
    EXPECT_EQ(parsePixelLimit("12")->of(1000), 12u);
    EXPECT_EQ(parsePixelLimit("0.5%")->of(1000), 5u);
    EXPECT_EQ(parsePixelLimit("0.19%")->of(1000), 1u);  // whole pixels
    EXPECT_EQ(parsePixelLimit("100%")->of(1000), 1000u);
    for (const char* text : {"", "%", "-1", "1.5", "101%", "-1%", "nan%", "12px", " 12", "1e3"}) {
        EXPECT_FALSE(parsePixelLimit(text).ok()) << text;
    }
}

Comparison someDifferences() {
    Comparison comparison;
    comparison.width = comparison.height = 10;
    comparison.different = 5;
    comparison.depth = DepthMeasures{3, 2};
    comparison.range = RangeMeasures{3, 4, 1, {}};
    return comparison;
}

TEST(Limits, WhatIsNotAskedForIsNotBroken) {
    EXPECT_THAT(brokenLimits(someDifferences(), {}), IsEmpty());
}

TEST(Limits, TiesCountAsDifferentUnlessTheyHaveTheirOwnLimit) {
    Limits limits;
    limits.different = PixelLimit{4, {}};
    EXPECT_THAT(brokenLimits(someDifferences(), limits),
                ElementsAre(HasSubstr("5 pixels differ, allowed are 4")));
    limits.ties = PixelLimit{2, {}};
    EXPECT_THAT(brokenLimits(someDifferences(), limits), IsEmpty());
    limits.different = PixelLimit{2, {}};
    limits.ties = PixelLimit{1, {}};
    EXPECT_THAT(brokenLimits(someDifferences(), limits),
                ElementsAre(HasSubstr("3 pixels"), HasSubstr("2 pixels")));
}

TEST(Limits, OfTheRange) {
    Limits limits;
    limits.outside = PixelLimit{0, 4.0};  // 4 % of 100 pixels
    limits.seeThrough = PixelLimit{1, {}};
    EXPECT_THAT(brokenLimits(someDifferences(), limits), IsEmpty());
    limits.outside = PixelLimit{3, {}};
    limits.seeThrough = PixelLimit{0, {}};
    EXPECT_THAT(brokenLimits(someDifferences(), limits),
                ElementsAre(HasSubstr("outside"), HasSubstr("see-through")));
}

TEST(Report, JsonHoldsTheMeasures) {
    const Picture reference = greyWall(4, 4);
    Picture test = reference;
    test.color.at(1, 2)[0] = 0;
    *test.depth.at(3, 3) = 0;
    const auto report = nlohmann::json::parse(jsonReport(compareWithin(reference, test, 1), {"too bad"}));
    EXPECT_EQ(report["pixels"], 16);
    EXPECT_EQ(report["different_pixels"], 2);
    EXPECT_EQ(report["color"]["correct_pixels"], 15);
    EXPECT_EQ(report["color"]["correct_share"], 15.0 / 16);
    EXPECT_EQ(report["color"]["first_different"], (std::vector{1, 2}));
    EXPECT_EQ(report["depth"]["ties"], 1);
    EXPECT_EQ(report["range"]["see_through_pixels"], 1);
    EXPECT_EQ(report["within"], false);
    EXPECT_EQ(report["broken_limits"][0], "too bad");

    const auto same = nlohmann::json::parse(jsonReport(compare(reference, reference, std::nullopt), {}));
    EXPECT_TRUE(same["color"]["psnr_db"].is_null());
    EXPECT_TRUE(same["color"]["first_different"].is_null());
    EXPECT_EQ(same["within"], true);
}

}  // namespace
}  // namespace iwalk::tools
