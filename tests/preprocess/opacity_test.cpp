#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "preprocess/opacity/cell_opacity.hpp"

namespace iwalk {
namespace {

using Corners = std::vector<glm::vec3>;
using Coefficients = std::array<std::uint8_t, kOpacityDirections>;

Coefficients coefficientsOf(const Corners& corners) {
    CellOpacity cell;
    cell.add(corners);
    return cell.coefficients();
}

void addTriangle(Corners& corners, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    for (const glm::vec3& corner : {a, b, c}) corners.push_back(corner);
}

void addQuad(Corners& corners, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
             const glm::vec3& d) {
    addTriangle(corners, a, b, c);
    addTriangle(corners, a, c, d);
}

// A rectangle about the cell's centre, perpendicular to `normal`, far larger than the cell; or the half of it
// on one side of the centre.
Corners plate(const glm::vec3& normal, bool half) {
    const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0.3f, 0.5f, 0.81f), normal)) * 3.0f;
    const glm::vec3 up = glm::cross(normal, right), center(0.5f), low = half ? glm::vec3(0) : up;
    Corners corners;
    addQuad(corners, center - right - low, center + right - low, center + right + up, center - right + up);
    return corners;
}

// The sides of a box, closed.
Corners box(const glm::vec3& min, const glm::vec3& max) {
    Corners corners;
    const auto corner = [&](int i) {
        return glm::vec3((i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y,
                         (i & 4) != 0 ? max.z : min.z);
    };
    for (const auto& q : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                          std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
        addQuad(corners, corner(q[0]), corner(q[1]), corner(q[2]), corner(q[3]));
    return corners;
}

// Triangles of random shapes, some of them partly or wholly outside the cell.
Corners soup(std::size_t triangles, float size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-0.1f, 1.1f), offset(-size, size);
    Corners corners;
    for (std::size_t i = 0; i < triangles; ++i) {
        const glm::vec3 center(place(random), place(random), place(random));
        for (int corner = 0; corner < 3; ++corner)
            corners.push_back(center + glm::vec3(offset(random), offset(random), offset(random)));
    }
    return corners;
}

// A bumpy closed surface about the cell's centre, as a grid over the sphere.
Corners bumpySphere(int rows, float radius) {
    const int columns = 2 * rows;
    const auto point = [&](int row, int column) {
        const double latitude = std::numbers::pi * row / rows;
        const double longitude = 2 * std::numbers::pi * (column % columns) / columns;
        const double ring = row == 0 || row == rows ? 0 : std::sin(latitude);
        const double r =
            radius * (1 + 0.2 * std::sin(7 * latitude) * (ring == 0 ? 0 : std::sin(9 * longitude)));
        return glm::vec3(glm::dvec3(0.5) + r * glm::dvec3(ring * std::cos(longitude),
                                                          ring * std::sin(longitude), std::cos(latitude)));
    };
    Corners corners;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column)
            addQuad(corners, point(row, column), point(row + 1, column), point(row + 1, column + 1),
                    point(row, column + 1));
    }
    return corners;
}

TEST(OpacityDirection, AreTheUnitVectorsOfADodecahedron) {
    for (std::size_t i = 0; i < kOpacityDirections; ++i) {
        EXPECT_NEAR(glm::length(kOpacityDirection[i]), 1, 1e-6);
        EXPECT_EQ(kOpacityDirection[(i + kOpacityAxes) % kOpacityDirections], -kOpacityDirection[i]);
        int neighbors = 0;  // every corner of a dodecahedron has three, 41.81 degrees away
        for (const glm::vec3& other : kOpacityDirection)
            neighbors +=
                std::abs(glm::dot(kOpacityDirection[i], other) - std::sqrt(5.0f) / 3) < 1e-6f ? 1 : 0;
        EXPECT_EQ(neighbors, 3);
    }
}

TEST(OpacityDirection, NearestIsTheOneWithTheSmallestAngle) {
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 direction(normal(random), normal(random), normal(random));
        const float cosine = glm::dot(kOpacityDirection[nearestDirection(direction)], direction);
        for (const glm::vec3& sample : kOpacityDirection) EXPECT_LE(glm::dot(sample, direction), cosine);
        EXPECT_GE(cosine / glm::length(direction), std::cos(37.4f / 180 * std::numbers::pi_v<float>));
    }
    for (std::size_t i = 0; i < kOpacityDirections; ++i)
        EXPECT_EQ(nearestDirection(5.0f * kOpacityDirection[i]), i);
}

TEST(CellOpacity, IsZeroWithoutTriangles) {
    CellOpacity cell;
    EXPECT_EQ(cell.coefficients(), Coefficients{});
    cell.add(box(glm::vec3(0), glm::vec3(1)));
    cell.clear();
    EXPECT_EQ(cell.coefficients(), Coefficients{});
}

TEST(CellOpacity, IsFullForTheCellsOwnSides) {
    Coefficients full;
    full.fill(255);
    EXPECT_EQ(coefficientsOf(box(glm::vec3(0), glm::vec3(1))), full);
    // Of this box only the three sides that meet in the origin touch the cell: along (1, 1, 1) they hide it.
    EXPECT_EQ(coefficientsOf(box(glm::vec3(0), glm::vec3(2)))[0], 255);
    EXPECT_LT(coefficientsOf(box(glm::vec3(0), glm::vec3(2)))[1], 255);
    // A box around the cell has nothing in it.
    EXPECT_EQ(coefficientsOf(box(glm::vec3(-1), glm::vec3(2))), Coefficients{});
}

// The area of the cell's section through its centre over its silhouette, seen along the section's normal.
// Along (1,1,1) these are regular hexagons of radius sqrt(1/2) and sqrt(2/3).
TEST(CellOpacity, PlateCoversItsSectionOfTheCell) {
    for (std::size_t i = 0; i < 4; ++i) {
        const int whole = coefficientsOf(plate(kOpacityDirection[i], false))[i];
        EXPECT_NEAR(whole, 255 * 0.75, 2);
        EXPECT_NEAR(coefficientsOf(plate(kOpacityDirection[i], true))[i], whole / 2, 2);
    }
}

TEST(CellOpacity, PlateSeenEdgeOnCoversNothing) {
    // Direction 4 lies in the plane x = 0.5.
    const Coefficients coefficients = coefficientsOf(plate(glm::vec3(1, 0, 0), false));
    EXPECT_LE(coefficients[4], 5);
    EXPECT_GT(coefficients[6], 150);
}

TEST(CellOpacity, OnlyNothingIsZeroAndOnlyAllIs255) {
    // All but a few pixels of the cell, and a pixel or none.
    const Coefficients most = coefficientsOf(box(glm::vec3(0.001f), glm::vec3(0.999f)));
    const Coefficients least = coefficientsOf(box(glm::vec3(0.47f), glm::vec3(0.51f)));
    EXPECT_GE(*std::min_element(most.begin(), most.end()), 253);
    EXPECT_EQ(std::count(most.begin(), most.end(), 255) % 2, 0);
    EXPECT_GT(std::count(most.begin(), most.end(), 254), 0);
    EXPECT_LE(*std::max_element(least.begin(), least.end()), 1);
    EXPECT_GT(std::count(least.begin(), least.end(), 1), 0);
}

TEST(CellOpacity, CountsOnlyWhatIsInTheCell) {
    Corners corners = box(glm::vec3(0.2f), glm::vec3(0.7f));
    const Coefficients alone = coefficientsOf(corners);
    for (const glm::vec3& offset :
         {glm::vec3(1.0f, 0, 0), glm::vec3(-0.8f, 0.3f, 0), glm::vec3(0, 0, 1e6f)}) {
        for (const glm::vec3& corner : box(glm::vec3(0.2f) + offset, glm::vec3(0.7f) + offset))
            corners.push_back(corner);
    }
    EXPECT_EQ(coefficientsOf(corners), alone);
}

TEST(CellOpacity, CellsThatShareABoxAddUpToIt) {
    // The left half of a box, in the cell it reaches into from outside and in a cell that holds the half.
    const Corners inside = box(glm::vec3(0.0f, 0.25f, 0.25f), glm::vec3(0.5f, 0.75f, 0.75f));
    const Corners across = box(glm::vec3(-3.0f, 0.25f, 0.25f), glm::vec3(0.5f, 0.75f, 0.75f));
    const Coefficients a = coefficientsOf(inside), b = coefficientsOf(across);
    // The side at x = 0 is missing: it is seen only where the others do not hide it.
    for (std::size_t i = 0; i < kOpacityDirections; ++i) EXPECT_LE(b[i], a[i]);
    EXPECT_EQ(b[4], a[4]);  // perpendicular to x
}

TEST(CellOpacity, OppositeDirectionsAreEqual) {
    const Coefficients coefficients = coefficientsOf(soup(300, 0.1f, 1));
    for (std::size_t i = 0; i < kOpacityAxes; ++i) EXPECT_EQ(coefficients[i], coefficients[i + kOpacityAxes]);
}

TEST(CellOpacity, DependsNeitherOnOrderNorOnSplitting) {
    const Corners corners = soup(3000, 0.05f, 2);
    const Coefficients once = coefficientsOf(corners);
    std::vector<std::size_t> order(corners.size() / 3);
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::mt19937 random(4);
    std::shuffle(order.begin(), order.end(), random);
    CellOpacity cell;
    for (const std::size_t i : order)
        cell.add(std::array{corners[3 * i + 2], corners[3 * i], corners[3 * i + 1]});
    EXPECT_EQ(cell.coefficients(), once);
}

TEST(CellOpacity, ClosedSurfacesHaveNoPinHoles) {
    // A finer mesh of the same closed surface may differ at the silhouette, but has no holes in it: so
    // covering the inside as well changes nothing.
    for (const int rows : {8, 33, 120}) {
        const Corners surface = bumpySphere(rows, 0.35f);
        Corners filled = surface;
        for (std::size_t i = 0; i < surface.size();
             i += 3) {  // fans from the centre: all rays inside are blocked
            const glm::vec3 center(0.5f);
            for (std::size_t k = 0; k < 3; ++k)
                addTriangle(filled, center, surface[i + k], surface[i + (k + 1) % 3]);
        }
        EXPECT_EQ(coefficientsOf(surface), coefficientsOf(filled)) << rows;
    }
}

TEST(CellOpacity, TessellatedSidesOfTheCellAreFull) {
    // The cell's sides and beyond, in triangles of a fraction of a pixel to several, corners jittered.
    std::mt19937 random(5);
    std::uniform_real_distribution<float> jitter(-0.3f, 0.3f);
    for (const int n : {10, 70, 300}) {
        const float step = 1.5f / static_cast<float>(n);
        std::vector<glm::vec2> grid;
        for (int i = 0; i <= n; ++i) {
            for (int k = 0; k <= n; ++k)
                grid.emplace_back((static_cast<float>(i) + jitter(random)) * step - 0.25f,
                                  (static_cast<float>(k) + jitter(random)) * step - 0.25f);
        }
        Corners corners;
        for (int side = 0; side < 6; ++side) {
            const auto at = [&](int i, int k) {
                const glm::vec2& p = grid[static_cast<std::size_t>(i * (n + 1) + k)];
                glm::vec3 q;
                const auto axis = static_cast<std::size_t>(side / 2);
                q[axis] = static_cast<float>(side % 2), q[(axis + 1) % 3] = p.x, q[(axis + 2) % 3] = p.y;
                return q;
            };
            for (int i = 0; i < n; ++i) {
                for (int k = 0; k < n; ++k)
                    addQuad(corners, at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
            }
        }
        for (const std::uint8_t c : coefficientsOf(corners)) EXPECT_EQ(c, 255) << n;
    }
}

TEST(CellOpacity, DegenerateAndNonFiniteTrianglesCoverNothing) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const glm::vec3 a(0.1f, 0.2f, 0.3f), b(0.9f, 0.8f, 0.6f);
    const Corners corners{a, a, a, a, b, b, b, a, b, a, 0.5f * (a + b), b, a + 5.0f, a + 5.0f, a + 5.0f};
    EXPECT_EQ(coefficientsOf({corners.begin(), corners.begin() + 9}), Coefficients{});
    for (const std::uint8_t c : coefficientsOf(corners)) EXPECT_LE(c, 1);  // as its middle is rounded
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        for (std::size_t i = 0; i < 9; ++i) {
            Corners triangle{a, b, glm::vec3(0.1f, 0.9f, 0.4f)};
            triangle[i / 3][i % 3] = bad;
            EXPECT_EQ(coefficientsOf(triangle), Coefficients{});
        }
    }
}

TEST(CellOpacity, HugeTrianglesAreClipped) {
    Corners corners;
    const float far = 1e30f;
    addQuad(corners, {-far, -far, 0.5f}, {far, -far, 0.5f}, {far, far, 0.5f}, {-far, far, 0.5f});
    const Corners sheet{{-9, -9, 0.5f}, {20, -9, 0.5f}, {-9, 20, 0.5f}};
    const Coefficients a = coefficientsOf(corners), b = coefficientsOf(sheet);
    for (std::size_t i = 0; i < kOpacityDirections; ++i) EXPECT_NEAR(a[i], b[i], 1);
}

}  // namespace
}  // namespace iwalk
