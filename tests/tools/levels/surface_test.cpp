#include "tests/tools/levels/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/tools/levels/shapes.hpp"

namespace iwalk::levels {
namespace {

double distanceTo(const FixedTriangle& triangle, const glm::dvec3& point) {
    return std::sqrt(squaredDistance(point, triangle));
}

TEST(TriangleDistance, ToInsideSidesAndCorners) {
    const FixedTriangle t{Corner(0, 0, 0), Corner(10, 0, 0), Corner(0, 10, 0)};
    EXPECT_DOUBLE_EQ(distanceTo(t, {2, 3, 7}), 7);
    EXPECT_DOUBLE_EQ(distanceTo(t, {2, 3, -7}), 7);
    EXPECT_DOUBLE_EQ(distanceTo(t, {2, 3, 0}), 0);
    EXPECT_DOUBLE_EQ(distanceTo(t, {5, -3, 4}), 5);
    EXPECT_DOUBLE_EQ(distanceTo(t, {13, 0, 4}), 5);
    EXPECT_DOUBLE_EQ(distanceTo(t, {-3, -4, 0}), 5);
    EXPECT_NEAR(distanceTo(t, {10, 10, 0}), std::sqrt(50), 1e-12);
}

TEST(TriangleDistance, OfDegenerateTrianglesIsThatOfTheLineOrPoint) {
    const Corner a(0, 0, 0), b(10, 0, 0), c(4, 0, 0);
    for (const FixedTriangle& line :
         {FixedTriangle{a, b, b}, {a, a, b}, {b, a, b}, {a, b, c}, {c, a, b}, {b, c, a}}) {
        EXPECT_DOUBLE_EQ(distanceTo(line, {7, 3, 4}), 5);
        EXPECT_DOUBLE_EQ(distanceTo(line, {13, 0, 4}), 5);
        EXPECT_DOUBLE_EQ(distanceTo(line, {-3, 4, 0}), 5);
    }
    EXPECT_DOUBLE_EQ(distanceTo({b, b, b}, {7, 4, 0}), 5);
}

// A needle as long as the grid and one part wide.
TEST(TriangleDistance, OfNeedlesIsExactEnough) {
    const std::int32_t far = 1 << 30;
    const FixedTriangle needle{Corner(-far, -far, -far), Corner(far, far, far), Corner(far, far, far - 1)};
    for (const double s : {-0.9, -0.3, 0.0, 0.7}) {
        const glm::dvec3 on = s * glm::dvec3(far);
        const glm::dvec3 away = glm::normalize(glm::dvec3(1, -1, 0));  // perpendicular to it
        EXPECT_NEAR(distanceTo(needle, on + 1000.0 * away), 1000, 1e-3);
    }
}

// Triangles of every size, lines and copies among them.
std::vector<FixedTriangle> soup(std::size_t count, std::mt19937& random) {
    std::uniform_real_distribution<double> place(0, 1), size(-16, -1);
    std::vector<FixedTriangle> triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 center(place(random), place(random), place(random));
        const double scale = std::exp2(size(random));
        FixedTriangle t;
        for (Corner& corner : t) {
            const glm::dvec3 offset(place(random), place(random), place(random));
            corner = Corner(kParts * (center + scale * offset));
        }
        if (i % 7 == 0) t[1] = t[0];
        if (i % 11 == 0 && i > 0) t = triangles[i / 2];
        triangles.push_back(t);
    }
    return triangles;
}

TEST(Surface, DistanceIsTheLeastOfAllTriangles) {
    std::mt19937 random(1);
    for (const std::size_t count : {1, 2, 5, 300, 3000}) {
        const auto triangles = soup(count, random);
        const Surface surface(triangles);
        EXPECT_EQ(surface.triangles().size(), count);
        std::uniform_real_distribution<double> place(-0.5, 1.5);
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 point = kParts * glm::dvec3(place(random), place(random), place(random));
            double least = squaredDistance(point, triangles[0]);
            for (const FixedTriangle& t : triangles) least = std::min(least, squaredDistance(point, t));
            EXPECT_EQ(surface.distance(point), std::sqrt(least));
        }
    }
}

TEST(Surface, ManyTrianglesInOnePlaceAreNoProblem) {
    const std::vector<FixedTriangle> copies(10000, {Corner(1, 2, 3), Corner(4, 5, 6), Corner(7, 8, 10)});
    EXPECT_EQ(Surface(copies).distance({1, 2, 0}), 3);
}

}  // namespace
}  // namespace iwalk::levels
