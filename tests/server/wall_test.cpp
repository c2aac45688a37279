#include "server/wall/wall.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "server/visibility/eye.hpp"
#include "server/wall/projection.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk {
namespace {

using ::testing::HasSubstr;

std::string errorOf(const std::string& text) {
    const TempDirectory directory;
    const std::string path = directory.path("wall.toml");
    std::ofstream(path) << text;
    const Result<Wall> wall = loadWall(path);
    return wall.ok() ? "" : wall.error().message.substr(directory.path("").size() + 1);
}

TEST(Wall, EveryConfigLoads) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(IWALK_CONFIG_DIR)) {
        if (entry.path().extension() != ".toml") continue;
        const Result<Wall> wall = loadWall(entry.path());
        EXPECT_TRUE(wall.ok()) << wall.error().message;
        ++files;
    }
    EXPECT_GE(files, 4);
}

TEST(Wall, BezelsLieBetweenTiles) {
    const TempDirectory directory;
    const std::string path = directory.path("wall.toml");
    std::ofstream(path) << "[wall]\nrows = 2\ncolumns = 3\ntile_px = [100, 50]\nbezel_px = [10, 4]\n"
                           "[settings]\ncache = \"64M\"\nfetch-threads = 3\n";
    const Result<Wall> wall = loadWall(path);
    ASSERT_TRUE(wall.ok()) << wall.error().message;
    EXPECT_EQ(wall->width, 320);
    EXPECT_EQ(wall->height, 104);
    ASSERT_EQ(wall->tiles.size(), 6u);
    EXPECT_EQ(wall->tiles[5].name, "tile-1-2");
    EXPECT_EQ(wall->tiles[5].onWall, (PixelRect{220, 54, 100, 50}));
    ASSERT_EQ(wall->settings.size(), 2u);
}

TEST(Wall, ErrorsNameLineAndColumn) {
    EXPECT_EQ(errorOf("[wall]\nrows = 2\ncolums = 2\ncolumns = 2\ntile_px = [4, 4]\n"),
              "wall.toml:3:1: [wall] knows no 'colums'");
    EXPECT_THAT(errorOf("[wall]\nrows = 2\ncolumns 2\n"), HasSubstr("wall.toml:3:"));
    EXPECT_THAT(errorOf("[wall]\nrows = 2\n"), HasSubstr("has no 'columns'"));
    EXPECT_EQ(errorOf("[wall]\nrows = 0\n"), "wall.toml:2:8: 'rows' wants whole numbers from 1 to 64");
    EXPECT_THAT(errorOf("[wall]\nrows = 1\ncolumns = 1\ntile_px = [1024]\n"),
                HasSubstr("wall.toml:4:11: 'tile_px'"));
    EXPECT_THAT(errorOf("[wall]\nrows = 1.5\n"), HasSubstr("wall.toml:2:8:"));
    EXPECT_THAT(errorOf("rows = 1\n"), HasSubstr("[wall]"));
    EXPECT_THAT(errorOf("[wall]\nrows=1\ncolumns=1\ntile_px=[1,1]\n[settings]\ncash = \"1G\"\n"),
                HasSubstr("wall.toml:6:1:"));
    EXPECT_THAT(loadWall("/nowhere/wall.toml").error().message, HasSubstr("/nowhere/wall.toml"));
}

Camera camera() {
    return {{3, -2, 5}, {1, 4, 2}, {0, 0.2, 1}, 47};
}

Wall wallOf(int width, int height) {
    Wall wall;
    wall.width = width;
    wall.height = height;
    return wall;
}

TEST(Projection, CentreCornersAndDistances) {
    const Wall wall = wallOf(400, 300);
    const ScreenProjection p = projectScreen(wall.screens(camera().fovY)[0], camera());
    const glm::dvec3 ahead = camera().target - camera().eye;
    const glm::dvec3 centre = p.toPixels * ahead;
    EXPECT_NEAR(centre.x / centre.z, 200, 1e-9);
    EXPECT_NEAR(centre.y / centre.z, 150, 1e-9);
    EXPECT_NEAR(centre.z, glm::length(ahead), 1e-12);

    // The field of view is vertical: half of it lies between the centre and the top edge.
    const glm::dvec3 top = p.toDirection * glm::dvec3(200, 0, 1);
    const double angle = std::acos(glm::dot(top, ahead) / glm::length(top) / glm::length(ahead));
    EXPECT_NEAR(angle * 360 / 3.14159265358979, 47, 1e-9);
    EXPECT_GT(glm::dot(top, camera().up), glm::dot(p.toDirection * glm::dvec3(200, 300, 1), camera().up));
}

TEST(Projection, FrustumAgreesWithPixels) {
    const Wall wall = wallOf(400, 300);
    const ScreenProjection p = projectScreen(wall.screens(camera().fovY)[0], camera());
    const PixelRect rect{100, 20, 50, 80};
    const Frustum frustum = frustumOf(p, rect, 0, 0.1);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> number(-5, 5);
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 v(number(random), number(random), number(random));
        const glm::dvec3 q = p.toPixels * v;
        const bool seen =
            q.z >= 0.1 && q.x >= 100 * q.z && q.x <= 150 * q.z && q.y >= 20 * q.z && q.y <= 100 * q.z;
        bool in = glm::dot(frustum.forward, v) >= frustum.near;
        for (const glm::dvec3& plane : frustum.planes) in = in && glm::dot(plane, v) >= 0;
        EXPECT_EQ(in, seen);
        inside += in;
    }
    EXPECT_GT(inside, 20);
}

TEST(LatticeEye, DifferencesAreExactFarFromTheOrigin) {
    const LatticeEye eye = LatticeEye::at({1e7 + 0.125, -1e7, 0.3}, -20);
    const glm::dvec3 v =
        eye.to(LatticePoint(std::int64_t{10000000} << 20, -(std::int64_t{10000000} << 20), 0));
    EXPECT_EQ(v.x, -0.125 * 0x1p20);
    EXPECT_EQ(v.y, 0);
    EXPECT_NEAR(v.z, -0.3 * 0x1p20, 0x1p-16);
}

}  // namespace
}  // namespace iwalk
