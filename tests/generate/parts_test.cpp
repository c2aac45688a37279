// The pieces that the scenes are made of.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "preprocess/generate/cube_table.hpp"
#include "preprocess/generate/gradient_noise.hpp"
#include "preprocess/generate/mixing_field.hpp"
#include "preprocess/generate/trigonometry.hpp"

namespace iwalk {
namespace {

TEST(TrigonometryTest, IsAccurate) {
    for (int i = -1000; i <= 1000; ++i) {
        const double turns = i * 0.00371;
        const glm::dvec2 at = onCircle(turns);
        EXPECT_NEAR(at.x, std::cos(turns * 2 * std::numbers::pi), 1e-14);
        EXPECT_NEAR(at.y, std::sin(turns * 2 * std::numbers::pi), 1e-14);
    }
    EXPECT_EQ(onCircle(0.25), glm::dvec2(0, 1));
    EXPECT_EQ(onCircle(-0.5), glm::dvec2(-1, 0));
}

TEST(CubeTableTest, CrossesWhatItMust) {
    const CubeTable table = makeCubeTable();
    EXPECT_TRUE(table[0].triangles.empty());
    EXPECT_TRUE(table[255].triangles.empty());
    for (unsigned inside = 0; inside < 256; ++inside) {
        std::set<unsigned> used, crossed;
        for (const CubeTriangles& triangle : table[inside].triangles)
            used.insert(triangle.begin(), triangle.end());
        for (unsigned edge = 0; edge < 12; ++edge) {
            const unsigned from = cubeEdge(edge).from, to = from + (1u << cubeEdge(edge).axis);
            if ((inside >> from & 1) != (inside >> to & 1)) crossed.insert(edge);
        }
        EXPECT_EQ(used, crossed) << inside;
    }
}

TEST(GradientNoiseTest, IsSmoothAndNoneAtCorners) {
    EXPECT_EQ(gradientNoise({3, -4, 5}, 1), 0.0f);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 at(static_cast<float>(i) * 0.137f - 60, 0.3f, static_cast<float>(i) * -0.071f);
        const float value = gradientNoise(at, 1);
        EXPECT_LE(std::abs(value), 1.1f);
        EXPECT_NEAR(gradientNoise(at + glm::vec3(1e-3f), 1), value, 0.02f);
    }
}

// A slab's values do not depend on which slabs were asked for before.
TEST(MixingFieldTest, IsAFunctionOfThePlace) {
    const IsosurfaceGrid grid = IsosurfaceGrid::of(90, 1);
    std::vector<float> one(grid.rows() * grid.stride()), other(one.size());
    MixingField inOrder(5, grid), atOnce(5, grid);
    for (std::uint32_t x = 0; x <= 70; ++x) inOrder.slab(x, one);
    atOnce.slab(70, other);
    EXPECT_EQ(one, other);
    for (std::size_t y = 0; y < grid.stride(); ++y) {
        EXPECT_LT(one[y], 0);                                             // the bottom
        EXPECT_GT(one[std::size_t{grid.layers} * grid.stride() + y], 0);  // the top
    }
}

}  // namespace
}  // namespace iwalk
