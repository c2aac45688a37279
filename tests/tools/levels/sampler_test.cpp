#include "tests/tools/levels/sampler.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/levels/deviation.hpp"
#include "tests/tools/levels/shapes.hpp"

namespace iwalk::levels {
namespace {

constexpr SampleOptions kOptions{20'000, 1};

TEST(Sampler, PointsLieOnTheTrianglesEvenly) {
    const auto triangles = plane(7, 0.25);
    const auto points = sampleArea(triangles, 10'000, 3);
    ASSERT_EQ(points.size(), 10'000u);
    int quarter = 0;
    for (const glm::dvec3& p : points) {
        EXPECT_NEAR(p.z, kParts / 4, 1e-6);
        EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.x <= kParts && p.y <= kParts);
        quarter += p.x < kParts / 2 && p.y < kParts / 2 ? 1 : 0;
    }
    EXPECT_NEAR(quarter, 2500, 100);
    EXPECT_NE(points, sampleArea(triangles, 10'000, 4));
    EXPECT_EQ(points, sampleArea(triangles, 10'000, 3));
}

TEST(Sampler, SmallTrianglesGetTheirShareAndLinesNone) {
    auto triangles = plane(1, 0);
    for (const FixedTriangle& t : toFixed(tools::box({2, 2, 2}, {2.1, 2.1, 2.1}))) triangles.push_back(t);
    triangles.push_back({Corner(0, 0, 99), Corner(0, 1000, 99), Corner(0, 0, 99)});
    int small = 0;
    for (const glm::dvec3& p : sampleArea(triangles, 50'000, 5)) {
        small += p.x > 1.5 * kParts ? 1 : 0;
        EXPECT_NE(p.z, 99);
    }
    EXPECT_NEAR(small, 50'000 * 0.06 / 1.06, 2);  // in strata the share is exact but for the borders
}

TEST(Sampler, LinesAreSampledByTheirLength) {
    auto triangles = plane(3, 0);
    EXPECT_TRUE(sampleLines(triangles, 100, 1).empty());
    triangles.push_back({Corner(0, 0, 7), Corner(0, 3000, 7), Corner(0, 0, 7)});
    triangles.push_back({Corner(5, 0, 7), Corner(5, 1000, 7), Corner(5, 1000, 7)});
    int first = 0;
    for (const glm::dvec3& p : sampleLines(triangles, 1000, 1)) {
        EXPECT_NEAR(p.z, 7, 1e-12);
        first += p.x == 0 ? 1 : 0;
    }
    EXPECT_NEAR(first, 750, 1);
}

TEST(Spread, PercentilesAreValuesOfTheSample) {
    std::vector<double> values;
    for (int i = 1000; i > 0; --i) values.push_back(i);
    const Spread spread = spreadOf(values);
    EXPECT_EQ(spread.median, 500);
    EXPECT_EQ(spread.p99, 990);
    EXPECT_EQ(spread.p999, 999);
    EXPECT_EQ(spread.max, 1000);
    EXPECT_EQ(spreadOf({4}).median, 4);
    EXPECT_EQ(spreadOf({}).max, 0);
}

TEST(Deviation, OfParallelPlanesIsTheirDistance) {
    const Reference full(plane(20, 0), kOptions);
    const Deviation deviation = deviationOf(plane(3, 0.125), full, kParts / 8);
    for (const Spread& spread : {deviation.fromFull, deviation.toFull}) {
        EXPECT_NEAR(spread.median, 1, 1e-12);
        EXPECT_NEAR(spread.max, 1, 1e-12);
    }
    EXPECT_EQ(deviation.linesToFull.max, 0);
}

TEST(Deviation, OfACoarseSphereIsItsSagitta) {
    const Reference full(toFixed(tools::sphere(1, 6)), kOptions);
    const auto coarse = toFixed(tools::sphere(1, 3));
    // Faces sag most in their middle.
    double inner = 1;
    for (const FixedTriangle& t : coarse) {
        const glm::dvec3 n = normalOf(t);
        inner = std::min(inner, std::abs(glm::dot(n, toDouble(t[0]))) / glm::length(n) / kParts);
    }
    const Deviation deviation = deviationOf(coarse, full, kParts);
    for (const Spread& spread : {deviation.fromFull, deviation.toFull}) {
        EXPECT_LT(spread.max, 1 - inner + 1e-6);
        EXPECT_GT(spread.max, 0.8 * (1 - inner));
        EXPECT_LT(spread.median, spread.p99);
    }
}

TEST(Deviation, MissingPartsShowFromTheInput) {
    auto two = toFixed(tools::sphere(0.25, 3));
    const auto one = two;
    for (const FixedTriangle& t : toFixed(tools::moved(tools::sphere(0.25, 3), {1, 0, 0}))) two.push_back(t);
    const Reference full(two, kOptions);
    const Deviation deviation = deviationOf(one, full, kParts);
    EXPECT_NEAR(deviation.toFull.max, 0, 1e-7);
    EXPECT_NEAR(deviation.fromFull.max, 1, 0.01);
    EXPECT_TRUE(std::isinf(deviationOf({}, full, kParts).largest()));
}

TEST(Deviation, StrayLinesShow) {
    const Reference full(plane(4, 0), kOptions);
    auto level = plane(2, 0);
    level.push_back({Corner(0, 0, 0), Corner(0, 0, 1 << 26), Corner(0, 0, 0)});
    const Deviation deviation = deviationOf(level, full, kParts);
    EXPECT_EQ(deviation.toFull.max, 0);
    EXPECT_NEAR(deviation.largest(), 0.25, 0.001);
}

}  // namespace
}  // namespace iwalk::levels
