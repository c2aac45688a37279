#include "tests/tools/scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <tuple>

#include "common/file.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk::tools {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Key = std::tuple<double, double, double>;

Key keyOf(const glm::dvec3& p) {
    return {p.x, p.y, p.z};
}

// Directed edges that no neighbour runs along the other way.
std::size_t openEdges(const Triangles& triangles) {
    std::map<std::pair<Key, Key>, int> balance;
    for (const Triangle& t : triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Key a = keyOf(t[i]), b = keyOf(t[(i + 1) % 3]);
            a < b ? ++balance[{a, b}] : --balance[{b, a}];
        }
    }
    std::size_t open = 0;
    for (const auto& [edge, sum] : balance) open += sum != 0;
    return open;
}

// Positive when triangles are counter-clockwise seen from outside.
double volume(const Triangles& triangles) {
    double sum = 0;
    for (const auto& [a, b, c] : triangles) sum += glm::dot(a, glm::cross(b, c)) / 6;
    return sum;
}

TEST(Scenes, SphereIsClosedAndOnItsRadius) {
    for (int subdivisions : {0, 1, 4}) {
        const Triangles triangles = sphere(2.5, subdivisions);
        EXPECT_EQ(triangles.size(), 20u << (2 * subdivisions));
        EXPECT_EQ(openEdges(triangles), 0u);
        for (const Triangle& t : triangles) EXPECT_NEAR(glm::length(t[0]), 2.5, 1e-12);
    }
    const double full = 4.0 / 3 * std::numbers::pi * std::pow(2.5, 3);
    EXPECT_NEAR(volume(sphere(2.5, 4)) / full, 1, 0.01);
}

TEST(Scenes, BoxIsClosedAndHasItsVolume) {
    const Triangles triangles = box({-1, 2, 3}, {1, 5, 7});
    EXPECT_EQ(triangles.size(), 12u);
    EXPECT_EQ(openEdges(triangles), 0u);
    EXPECT_DOUBLE_EQ(volume(triangles), 24);
}

TEST(Scenes, WindowHasFourOpenEdgesAndItsArea) {
    const Triangles triangles = boxWithWindow({0, 0, 0}, {4, 3, 2}, {1, 1}, {3, 2});
    EXPECT_EQ(triangles.size(), 18u);
    EXPECT_EQ(openEdges(triangles), 4u);
    double area = 0;
    for (const auto& [a, b, c] : triangles) area += glm::length(glm::cross(b - a, c - a)) / 2;
    EXPECT_DOUBLE_EQ(area, 2 * (4 * 3 + 4 * 2 + 3 * 2) - 2);
    // Seen from the origin the sides at max count; the window of 2 x 1 at z = 2 is missing.
    EXPECT_DOUBLE_EQ(volume(triangles), 24 - 2 * 2.0 / 3);
}

TEST(Scenes, MovedStaysClosed) {
    const Triangles triangles = moved(sphere(1, 3), {1e7, -1e7, 3});
    EXPECT_EQ(openEdges(triangles), 0u);
    EXPECT_NEAR(triangles[0][0].x, 1e7, 1.1);
}

class Ply : public testing::Test {
  protected:
    std::string written(const Triangles& triangles, const PlyOptions& options) const {
        const std::string path = directory_.path("scene.ply");
        EXPECT_TRUE(writePly(path, triangles, options).ok());
        return *readWholeFile(path, 1 << 20);
    }
    static std::string body(const std::string& file) { return file.substr(file.find("end_header\n") + 11); }

    TempDirectory directory_;
};

TEST_F(Ply, EqualCornersAreOneVertex) {
    const std::string file = written(box({0, 0, 0}, {1, 1, 1}), {});
    EXPECT_THAT(file,
                StartsWith("ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\n"));
    EXPECT_THAT(file, HasSubstr("element face 12\nproperty list uchar int vertex_indices\nend_header\n"));
    EXPECT_EQ(body(file).size(), 8u * 12 + 12 * 13);
}

TEST_F(Ply, DoublesKeepFarPositions) {
    const double x = 1e7 + 0.125;
    const std::string file = written({{{{x, 1, 2}, {3, 4, 5}, {6, 7, 8}}}}, {{}, true});
    EXPECT_THAT(file, HasSubstr("property double x\n"));
    double first = 0;
    std::memcpy(&first, body(file).data(), sizeof first);
    EXPECT_EQ(first, x);
    EXPECT_EQ(body(file).size(), 3u * 24 + 13);
}

TEST_F(Ply, ColorsDoNotBleed) {
    const Triangles pair{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 1, 0}, {1, 0, 0}, {1, 1, 0}}}};
    const std::string apart = written(pair, {{{255, 0, 0}, {0, 0, 255}}, false});
    EXPECT_THAT(apart, HasSubstr("element vertex 6\n"));
    EXPECT_THAT(apart, HasSubstr("property uchar red\n"));
    EXPECT_EQ(body(apart).substr(12, 3), std::string("\xff\0\0", 3));
    EXPECT_THAT(written(pair, {{{9, 9, 9}, {9, 9, 9}}, false}), HasSubstr("element vertex 4\n"));
}

}  // namespace
}  // namespace iwalk::tools
