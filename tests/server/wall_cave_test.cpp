// A CAVE shows one picture to its eye: what crosses a corner of the room goes on straight.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <optional>

#include "tests/server/render_fixture.hpp"
#include "tests/server/wall_renders.hpp"
#include "tests/tools/ray_caster.hpp"
#include "tests/tools/scenes.hpp"

namespace iwalk {
namespace {

using namespace tools;

using CaveTest = RenderTest;

// config/wall-cave.toml with a quarter of the pixels.
Wall smallCave() {
    Wall wall = loadWall(IWALK_CONFIG_DIR "/wall-cave.toml").value();
    const auto shrink = [](PixelRect& rect) {
        rect = {rect.x / 4, rect.y / 4, rect.width / 4, rect.height / 4};
    };
    for (Screen& screen : wall.freeScreens) screen.width /= 4, screen.height /= 4;
    for (Tile& tile : wall.tiles) shrink(tile.onScreen), shrink(tile.onWall);
    wall.width /= 4, wall.height /= 4;
    return wall;
}

// Askew, so that nothing hides behind equal axes; what it says of the field of view does not count.
const Camera kCamera{{5, -3, 2}, {5.6, -2.1, 2.3}, {0.1, -0.3, 1}, 33};

// From wall space to the directions of the model, by the words of docs/running-a-wall.md: -z is the view, y
// is towards up.
glm::dmat3 toModel() {
    const glm::dvec3 view = glm::normalize(kCamera.target - kCamera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(view, kCamera.up));
    return {right, glm::cross(right, view), -view};
}

// From the eye through a place on a screen (px), in wall space.
glm::dvec3 through(const Screen& screen, double x, double y) {
    return screen.topLeft + x / screen.width * (screen.topRight - screen.topLeft) +
           y / screen.height * (screen.bottomLeft - screen.topLeft);
}

double distanceBefore(const Screen& screen, const glm::dvec3& v) {
    const glm::dvec3 normal =
        glm::normalize(glm::cross(screen.bottomLeft - screen.topLeft, screen.topRight - screen.topLeft));
    return std::abs(glm::dot(normal, v));
}

constexpr double kLeft = -1, kRight = 1, kFront = -0.6;  // of the cube, metres from the eye

// Draws a cube of 2 m, and asks of every pixel whether its depth is the one that a ray from the eye finds.
class CubeInCave : public CaveTest {
  protected:
    void draw(double bottom) {
        cube_ = box({kLeft, bottom, kFront - 2}, {kRight, bottom + 2, kFront});
        caster_.emplace(cube_);
        Triangles model = cube_;
        for (tools::Triangle& triangle : model)
            for (glm::dvec3& corner : triangle) corner = kCamera.eye + toModel() * corner;
        dataset_ = build(model);
        picture_ = WallRenders(dataset_, Settings()).draw(wall_, kCamera);
    }
    double depthAt(const Tile& tile, int x, int y) const {
        return *picture_.depth.at(tile.onWall.x + x, tile.onWall.y + y);
    }
    // 0: nothing is hit.
    double castAt(const Screen& screen, double x, double y) const {
        const glm::dvec3 direction = through(screen, x, y);
        const Hit hit = caster_->cast({glm::dvec3(0), direction}, 1e-6);
        return hit.depth * distanceBefore(screen, direction);
    }
    // In a column, the rows down to the cube's last; 0: the column has nothing of it.
    int rowsDownTo(const Tile& tile, int x) const {
        int y = tile.onWall.height;
        while (y > 0 && depthAt(tile, x, y - 1) == 0) --y;
        return y;
    }

    const Wall wall_ = smallCave();
    Triangles cube_;
    Dataset dataset_;
    Picture picture_;
    std::optional<RayCaster> caster_;
};

TEST_F(CubeInCave, EveryPixelIsWhatTheEyeSees) {
    draw(-0.9);  // so low that the floor shows some of it
    for (const Tile& tile : wall_.tiles) {
        const Screen screen = wall_.screens(kCamera.fovY)[tile.screen];
        int seen = 0, wrong = 0;
        for (int y = 0; y < tile.onWall.height; ++y)
            for (int x = 0; x < tile.onWall.width; ++x) {
                const double drawn = depthAt(tile, x, y);
                seen += drawn > 0;
                const auto agrees = [&](double dx, double dy) {
                    const double cast = castAt(screen, x + 0.5 + dx, y + 0.5 + dy);
                    return std::abs(drawn - cast) <= 1e-3 * cast;
                };
                // At an edge of the cube a place next to the pixel's centre may count.
                const double d = 0.02;
                const bool right =
                    agrees(0, 0) || agrees(-d, 0) || agrees(d, 0) || agrees(0, -d) || agrees(0, d);
                wrong += !right;
            }
        EXPECT_EQ(wrong, 0) << tile.name;
        EXPECT_GT(seen, tile.onWall.width * tile.onWall.height / 20) << tile.name;
    }
}

// The cube's lower front edge, as the picture shows it: in each column of the three walls the place between
// the last pixel of the cube and the first below it.
TEST_F(CubeInCave, AnEdgeGoesOnStraightAcrossTheCorners) {
    const double bottom = -0.3;
    draw(bottom);
    // What is seen of a straight edge from one eye lies in a plane.
    const glm::dvec3 plane =
        glm::normalize(glm::cross(glm::dvec3(kLeft, bottom, kFront), glm::dvec3(kRight, bottom, kFront)));
    for (std::size_t i = 0; i < 3; ++i) {
        const Tile& tile = wall_.tiles[i];
        const Screen screen = wall_.screens(kCamera.fovY)[i];
        int columns = 0;
        for (int x = 1; x + 1 < tile.onWall.width; ++x) {
            const int y = rowsDownTo(tile, x);
            if (y == 0 || rowsDownTo(tile, x - 1) == 0 || rowsDownTo(tile, x + 1) == 0) continue;
            ++columns;
            const double above = glm::dot(plane, through(screen, x + 0.5, y - 0.51));
            const double below = glm::dot(plane, through(screen, x + 0.5, y + 0.51));
            EXPECT_LE(above * below, 0) << tile.name << ", column " << x;
        }
        EXPECT_GT(columns, tile.onWall.width / 8) << tile.name;
    }
    // The columns at both sides of a corner show the edge at one height of the room.
    const int last = wall_.tiles[0].onWall.width - 1;
    EXPECT_NEAR(rowsDownTo(wall_.tiles[0], last), rowsDownTo(wall_.tiles[1], 0), 1);
    EXPECT_NEAR(rowsDownTo(wall_.tiles[1], last), rowsDownTo(wall_.tiles[2], 0), 1);
}

}  // namespace
}  // namespace iwalk
