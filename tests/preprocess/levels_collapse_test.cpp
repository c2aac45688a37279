#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "preprocess/levels/collapse.hpp"
#include "tests/preprocess/levels_meshes.hpp"

namespace iwalk {
namespace {

glm::vec3 flat(std::uint32_t column, std::uint32_t row) {
    return glm::vec3(static_cast<float>(column), static_cast<float>(row), 0);
}

// What holds of every mesh: nothing moves on and on, and no triangle is left as a line by itself.
void expectSound(const Collapsed& collapsed) {
    for (const std::uint32_t image : collapsed.map.points) EXPECT_EQ(collapsed.map.points[image], image);
    for (const std::uint32_t image : collapsed.map.wedges) EXPECT_EQ(collapsed.map.wedges[image], image);
    for (const auto& line : collapsed.lines) {
        EXPECT_TRUE(collapsed.edges.contains(line)) << line[0] << " to " << line[1];
    }
}

TEST(CollapseTest, AFlatGridKeepsFewTrianglesAndShortEdges) {
    const Collapsed collapsed(gridMesh(40, 40, flat), {.error = 0.5f, .longestEdge = 8});
    expectSound(collapsed);
    EXPECT_LT(collapsed.triangles.size(), 500u);
    EXPECT_LE(collapsed.longestEdge(), 8.0f);
    EXPECT_NEAR(collapsed.area(), 1600, 0.01);  // its border is where it was, and nothing turned over
}

TEST(CollapseTest, LongEdgesMayStayButGetNoLonger) {
    const auto wide = [](std::uint32_t column, std::uint32_t row) {
        return glm::vec3(20 * static_cast<float>(column), static_cast<float>(row), 0);
    };
    const Collapsed collapsed(gridMesh(3, 40, wide), {.error = 0.5f, .longestEdge = 8});
    expectSound(collapsed);
    EXPECT_LE(collapsed.longestEdge(), std::hypot(20.0f, 1.0f) + 1e-3f);
    EXPECT_NEAR(collapsed.area(), 2400, 0.01);
}

// Six flat sides of 10 by 10 squares, equal points at their edges.
CollapseMesh makeBox() {
    CollapseMesh box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const bool top : {false, true}) {
            const auto side = [&](std::uint32_t column, std::uint32_t row) {
                glm::vec3 p(top ? 10 : 0);
                p[(axis + (top ? 1 : 2)) % 3] = static_cast<float>(column);
                p[(axis + (top ? 2 : 1)) % 3] = static_cast<float>(row);
                return p;
            };
            box = joined(box, gridMesh(10, 10, side));
        }
    }
    return welded(box);
}

TEST(CollapseTest, ABoxKeepsItsCorners) {
    const CollapseMesh box = makeBox();
    EXPECT_EQ(box.points.size(), 602u);
    const Collapsed collapsed(box, {.error = 0.4f, .longestEdge = 32});
    expectSound(collapsed);
    EXPECT_LT(collapsed.triangles.size(), 100u);
    EXPECT_NEAR(collapsed.area(), 600, 0.01);
    const auto isEnd = [](float x) { return x == 0 || x == 10; };
    int corners = 0;
    for (std::uint32_t i = 0; i < box.points.size(); ++i) {
        const glm::vec3& p = box.points[i];
        if (!isEnd(p.x) || !isEnd(p.y) || !isEnd(p.z)) continue;
        EXPECT_EQ(collapsed.map.points[i], i);
        ++corners;
    }
    EXPECT_EQ(corners, 8);
}

// A closed pipe with eight sides, along x.
CollapseMesh makePipe(float radius, std::uint32_t rings) {
    std::vector<glm::vec3> points;
    std::vector<Triple> triangles;
    for (std::uint32_t ring = 0; ring < rings; ++ring) {
        for (std::uint32_t side = 0; side < 8; ++side) {
            const float angle = static_cast<float>(side) * std::numbers::pi_v<float> / 4;
            points.emplace_back(ring, radius * std::cos(angle), radius * std::sin(angle));
            if (ring + 1 == rings) continue;
            const std::uint32_t a = 8 * ring + side, b = 8 * ring + (side + 1) % 8;
            triangles.push_back({a, b, b + 8});
            triangles.push_back({a, b + 8, a + 8});
        }
    }
    for (std::uint32_t side = 2; side < 8; ++side) {
        const std::uint32_t end = 8 * (rings - 1);
        triangles.push_back({0, side, side - 1});
        triangles.push_back({end, end + side - 1, end + side});
    }
    return makeMesh(std::move(points), std::move(triangles));
}

TEST(CollapseTest, AThinPipeNeverVanishes) {
    for (const std::uint32_t rings : {2u, 3u, 10u, 200u}) {
        for (const float error : {0.3f, 1.0f, 5.0f, 1000.0f}) {
            SCOPED_TRACE(testing::Message() << rings << " rings, error " << error);
            const Collapsed collapsed(makePipe(0.1f, rings), {error, 32 * error});
            expectSound(collapsed);
            EXPECT_GE(collapsed.triangles.size(), 2u);
            EXPECT_LT(collapsed.triangles.size(), rings == 200 ? 1000u : 161u);
            // As long as it was, but for the error.
            float low = INFINITY, high = -INFINITY;
            for (const std::uint32_t point : collapsed.points) {
                low = std::min(low, collapsed.mesh.points[point].x);
                high = std::max(high, collapsed.mesh.points[point].x);
            }
            EXPECT_GE(high - low, static_cast<float>(rings - 1) - 2 * error);
        }
    }
}

TEST(CollapseTest, HeldPointsStay) {
    const auto hill = [](std::uint32_t column, std::uint32_t row) {
        const float x = static_cast<float>(column), y = static_cast<float>(row);
        return glm::vec3(x, y, 2 * std::sin(0.3f * x) * std::cos(0.2f * y));
    };
    CollapseMesh mesh = gridMesh(40, 40, hill);
    std::mt19937 random(1);
    for (std::uint8_t& held : mesh.held) held = random() % 7 == 0 ? 1 : 0;
    const Collapsed collapsed(mesh, {.error = 3, .longestEdge = 96});
    expectSound(collapsed);
    for (std::uint32_t i = 0; i < mesh.points.size(); ++i) {
        EXPECT_TRUE(mesh.held[i] == 0 || collapsed.map.points[i] == i) << i;
    }
    const Collapsed free(gridMesh(40, 40, hill), {.error = 3, .longestEdge = 96});
    EXPECT_LT(free.points.size(), collapsed.points.size());
}

TEST(CollapseTest, ErrorsOfPointsCount) {
    CollapseMesh mesh = gridMesh(20, 20, flat);
    std::ranges::fill(mesh.errors, 0.5f);
    const Collapsed none(mesh, {.error = 0.4f, .longestEdge = 8});
    EXPECT_EQ(none.triangles.size(), 800u);
    CollapseMesh used = mesh;
    const CollapseMap map = collapse(used, {.error = 0.9f, .longestEdge = 8});
    for (std::uint32_t i = 0; i < map.points.size(); ++i) {
        EXPECT_GE(used.errors[map.points[i]], 0.5f);
        EXPECT_LE(used.errors[map.points[i]], 0.9f);
    }
}

TEST(CollapseTest, ColoursThatMeetKeepTheirLine) {
    constexpr std::uint32_t kRed = 0xff0000ff, kBlue = 0xffff0000;
    const auto colorOf = [](std::uint32_t column) { return column < 17 ? kRed : kBlue; };
    const Collapsed collapsed(gridMesh(40, 40, flat, colorOf), {.error = 0.5f, .longestEdge = 16});
    expectSound(collapsed);
    EXPECT_LT(collapsed.triangles.size(), 500u);
    for (std::size_t i = 0; i < collapsed.triangles.size(); ++i) {
        const std::uint32_t color = colorOf(static_cast<std::uint32_t>(collapsed.kept[i] / 2 % 40));
        EXPECT_TRUE(collapsed.isColor(i, color)) << "triangle " << collapsed.kept[i];
    }
    EXPECT_NEAR(collapsed.area(kRed), 17 * 40, 0.01);
    EXPECT_NEAR(collapsed.area(kBlue), 23 * 40, 0.01);
}

TEST(CollapseTest, PlatesNearerThanTheLimitJoin) {
    const auto plates = [](float apart) {
        const auto above = [&](std::uint32_t column, std::uint32_t row) {
            return flat(column, row) + glm::vec3(0, 0, apart);
        };
        return Collapsed(joined(gridMesh(20, 20, flat), gridMesh(20, 20, above)), {0.9f, 16});
    };
    const auto inBoth = [](const Collapsed& collapsed) {
        std::size_t crossings = 0;
        for (std::uint32_t i = 0; i < collapsed.map.points.size(); ++i) {
            crossings += i / 441 != collapsed.map.points[i] / 441 ? 1u : 0u;
        }
        return crossings;
    };
    const Collapsed near = plates(0.5f), far = plates(1.0f);
    expectSound(near);
    expectSound(far);
    EXPECT_EQ(inBoth(far), 0u);
    EXPECT_GT(inBoth(near), 100u);
    EXPECT_LT(static_cast<double>(near.points.size()), 0.6 * static_cast<double>(far.points.size()));
    EXPECT_NEAR(far.area(), 800, 0.01);
}

TEST(CollapseTest, DependsOnTheMeshAlone) {
    const CollapseMesh pipe = makePipe(0.4f, 50);
    EXPECT_EQ(Collapsed(pipe, {0.5f, 16}).map.points, Collapsed(pipe, {0.5f, 16}).map.points);
}

TEST(CollapseErrorsTest, AreWhatItTakes) {
    CollapseMesh mesh = gridMesh(10, 10, flat);
    mesh.points[60].z = 0.25f;
    const std::vector<std::uint32_t> points{0, 60, 24};
    const std::vector<float> errors = collapseErrors(mesh, points, 32);
    ASSERT_EQ(errors.size(), 3u);
    EXPECT_GT(errors[0], 0.5f);  // a corner
    // As far as the bump is high, or more: distances from planes are bounds.
    EXPECT_GE(errors[1], 0.24f);
    EXPECT_LE(errors[1], 0.5f);
    EXPECT_LT(errors[2], 0.1f);  // flat: only the edges' length counts
}

}  // namespace
}  // namespace iwalk
