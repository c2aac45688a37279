#include "server/wall/wall.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "server/visibility/eye.hpp"
#include "server/wall/assign.hpp"
#include "server/wall/projection.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk {
namespace {

using ::testing::HasSubstr;

Result<Wall> wallFrom(const std::string& text) {
    const TempDirectory directory;
    const std::string path = directory.path("wall.toml");
    std::ofstream(path) << text;
    Result<Wall> wall = loadWall(path);
    if (!wall.ok()) return Error{wall.error().message.substr(directory.path("").size() + 1)};
    return wall;
}

std::string errorOf(const std::string& text) {
    const Result<Wall> wall = wallFrom(text);
    return wall.ok() ? "" : wall.error().message;
}

TEST(Wall, EveryConfigLoads) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(IWALK_CONFIG_DIR)) {
        if (entry.path().extension() != ".toml") continue;
        const Result<Wall> wall = loadWall(entry.path());
        EXPECT_TRUE(wall.ok()) << wall.error().message;
        ++files;
    }
    EXPECT_GE(files, 7);
}

TEST(Wall, BezelsLieBetweenTiles) {
    const Result<Wall> wall = wallFrom(
        "[wall]\nrows = 2\ncolumns = 3\ntile_px = [100, 50]\nbezel_px = [10, 4]\n"
        "[settings]\ncache = \"64M\"\nfetch-threads = 3\n");
    ASSERT_TRUE(wall.ok()) << wall.error().message;
    EXPECT_EQ(wall->width, 320);
    EXPECT_EQ(wall->height, 104);
    ASSERT_EQ(wall->tiles.size(), 6u);
    EXPECT_EQ(wall->tiles[5].name, "tile-1-2");
    EXPECT_EQ(wall->tiles[5].onWall, (PixelRect{220, 54, 100, 50}));
    ASSERT_EQ(wall->settings.size(), 2u);
}

TEST(Wall, BezelsInMetresBecomePixels) {
    const Result<Wall> wall = wallFrom(
        "[wall]\nrows = 2\ncolumns = 2\ntile_px = [1000, 500]\ntile_m = [1, 0.6]\nbezel_m = [0.02, 0.0301]\n"
        "name = [[\"a\", \"b\"], [\"c\", \"d\"]]\nhost = \"pc\"\nwindow = [[[0, 0], [1, 2]], [[3, 4], [5, "
        "-6]]]\n");
    ASSERT_TRUE(wall.ok()) << wall.error().message;
    EXPECT_EQ(wall->tiles[3].onWall, (PixelRect{1020, 525, 1000, 500}));
    EXPECT_NEAR(wall->pixelAspect, 1e-3 / 1.2e-3, 1e-12);
    EXPECT_EQ(wall->tiles[2].name, "c");
    EXPECT_EQ(wall->tiles[2].host, "pc");
    EXPECT_EQ(wall->tiles[3].window, glm::ivec2(5, -6));
    // The screen has the shape that it has in metres.
    const Screen screen = wall->screens(60)[0];
    const double ratio = (screen.topRight.x - screen.topLeft.x) / (screen.topLeft.y - screen.bottomLeft.y);
    EXPECT_NEAR(ratio, 2020 * 1.0 / (1025 * 1.2), 1e-12);
}

TEST(Wall, ProjectorsShareThePixelsOfTheirOverlap) {
    const Result<Wall> wall =
        wallFrom("[wall]\nrows = 2\ncolumns = 3\ntile_px = [100, 80]\noverlap_px = [20, 10]\ngamma = 1.8\n");
    ASSERT_TRUE(wall.ok()) << wall.error().message;
    EXPECT_EQ(wall->width, 260);
    EXPECT_EQ(wall->height, 150);
    const Tile& tile = wall->tiles[4];
    EXPECT_EQ(tile.onWall, (PixelRect{80, 70, 100, 80}));
    EXPECT_EQ(tile.blend.left, 20);
    EXPECT_EQ(tile.blend.right, 20);
    EXPECT_EQ(tile.blend.top, 10);
    EXPECT_EQ(tile.blend.bottom, 0);
    EXPECT_EQ(tile.blend.gamma, 1.8);
    EXPECT_EQ(wall->tiles[0].blend.left, 0);
    EXPECT_EQ(wall->tiles[5].blend.right, 0);
}

constexpr const char* kFront =
    "[wall]\neye = [0, 1, 1]\n[[screen]]\nname = \"front\"\ntop_left = [-2, 2, -1]\n"
    "top_right = [2, 2, -1]\nbottom_left = [-2, 0, -1]\ntile_px = [200, 200]\n";

TEST(Wall, FreeScreensStandAroundTheEye) {
    const Result<Wall> wall = wallFrom(std::string(kFront) +
                                       "columns = 2\nbezel_m = [0.04, 0]\n[[screen]]\nname = \"floor\"\n"
                                       "top_left = [-2, 0, -1]\ntop_right = [2, 0, -1]\n"
                                       "bottom_left = [-2, 0, 3]\ntile_px = [50, 60]\n");
    ASSERT_TRUE(wall.ok()) << wall.error().message;
    ASSERT_EQ(wall->tiles.size(), 3u);
    EXPECT_EQ(wall->tiles[1].name, "front-0-1");
    EXPECT_EQ(wall->tiles[1].onScreen, (PixelRect{204, 0, 200, 200}));  // 396 cm for 400 px
    EXPECT_EQ(wall->tiles[2].name, "floor");
    EXPECT_EQ(wall->tiles[2].screen, 1u);
    EXPECT_EQ(wall->tiles[2].onScreen, (PixelRect{0, 0, 50, 60}));
    EXPECT_EQ(wall->tiles[2].onWall, (PixelRect{404, 0, 50, 60}));
    const std::vector<Screen> screens = wall->screens(20);
    ASSERT_EQ(screens.size(), 2u);
    EXPECT_EQ(screens[0].topLeft, glm::dvec3(-2, 1, -2));
    EXPECT_EQ(screens[1].bottomLeft, glm::dvec3(-2, -1, 2));
    EXPECT_EQ(wall->screens(90)[1].topRight, screens[1].topRight);  // whatever the field of view
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

TEST(Wall, ErrorsOfGridsNameLineAndColumn) {
    const std::string grid = "[wall]\nrows = 1\ncolumns = 2\ntile_px = [100, 50]\n";
    const auto said = [&](const char* more) { return errorOf(grid + more); };
    EXPECT_THAT(said("bezel_px = [1, 1]\noverlap_px = [1, 1]\n"), HasSubstr("wall.toml:6:14: one of"));
    EXPECT_THAT(said("bezel_m = [0.1, 0.1]\n"), HasSubstr("wall.toml:5:11: 'bezel_m' wants 'tile_m'"));
    EXPECT_THAT(said("tile_m = [1, -1]\n"), HasSubstr("wall.toml:5:14: 'tile_m' wants numbers from"));
    EXPECT_THAT(said("tile_m = [100, 1]\n"), HasSubstr("wall.toml:5:10: pixels of"));
    EXPECT_THAT(said("tile_m = [1, 0.5]\nbezel_m = [900, 0]\n"), HasSubstr("wall.toml:6:11: such bezels"));
    EXPECT_THAT(said("overlap_px = [51, 0]\n"), HasSubstr("wall.toml:5:14: neighbours overlap by half"));
    EXPECT_THAT(said("gamma = 2\n"), HasSubstr("wall.toml:5:9: 'gamma' goes with"));
    EXPECT_THAT(said("overlap_px = [5, 0]\ngamma = nan\n"), HasSubstr("wall.toml:6:9: 'gamma' wants"));
    EXPECT_THAT(said("host = [\"a\"]\n"), HasSubstr("wall.toml:5:9: 'host' wants one value for all"));
    EXPECT_THAT(said("host = [[\"a\"]]\n"), HasSubstr("wall.toml:5:9: 'host' wants one value for all"));
    EXPECT_THAT(said("host = [[\"a\", 7]]\n"), HasSubstr("wall.toml:5:15: 'host' wants texts"));
    EXPECT_THAT(said("host = \"a b\"\n"), HasSubstr("wall.toml:5:8: 'host' wants texts"));
    EXPECT_THAT(said("window = [[[0, 0], [0]]]\n"), HasSubstr("wall.toml:5:20: 'window' wants places"));
    EXPECT_THAT(said("window = [0, 99999]\n"), HasSubstr("wall.toml:5:14: 'window' wants whole"));
    EXPECT_THAT(said("window = [0, 0]\nmonitor = \"DP-1\"\n"), HasSubstr("wall.toml:5:10: a tile fills"));
    EXPECT_THAT(said("name = [[\"a\", \"a\"]]\n"), HasSubstr("two tiles are named 'a'"));
    EXPECT_THAT(said("name = [[\"a\", \"../b\"]]\n"), HasSubstr("wall.toml:5:8: '../b' is no name"));
    EXPECT_THAT(said("screen = 3\n"), HasSubstr("wall.toml:5:1: [wall] knows no 'screen'"));
}

TEST(Wall, ErrorsOfFreeScreensNameLineAndColumn) {
    const auto said = [](const std::string& from, const std::string& to) {
        std::string text = kFront;
        return errorOf(text.replace(text.find(from), from.size(), to));
    };
    EXPECT_EQ(said("eye", "eye"), "");
    EXPECT_THAT(said("eye = [0, 1, 1]", "rows = 1"), HasSubstr("wall.toml:2:1: [wall] knows no 'rows'"));
    EXPECT_THAT(said("eye = [0, 1, 1]", ""), HasSubstr("wall.toml:1:1: [wall] has no 'eye'"));
    EXPECT_THAT(said("[0, 1, 1]", "[0, 1]"), HasSubstr("wall.toml:2:7: 'eye' wants 3 numbers"));
    EXPECT_THAT(said("[0, 1, 1]", "[0, 1, inf]"), HasSubstr("wall.toml:2:14: 'eye' wants numbers from"));
    EXPECT_THAT(said("[0, 1, 1]", "[0, 1, -2]"), HasSubstr("wall.toml:5:12: the eye stands 1 m behind"));
    EXPECT_THAT(said("[-2, 2, -1]", "[2, 2, -1]"), HasSubstr("wall.toml:5:12: the screen's corners lie"));
    EXPECT_THAT(said("[-2, 0, -1]", "[-1.9, 0, -1]"), HasSubstr("wall.toml:5:12: the screen's corners make"));
    EXPECT_THAT(said("name = \"front\"", ""), HasSubstr("wall.toml:3:1: [[screen]] has no 'name'"));
    EXPECT_THAT(said("tile_px", "tile_m = [1, 1]\ntile_px"), HasSubstr("wall.toml:8:1: [[screen]] knows no"));
    EXPECT_THAT(said("[[screen]]", "[screen]"), HasSubstr("wall.toml:3:1: screens are tables: [[screen]]"));
}

Wall wallOnHosts(const std::vector<std::string>& hosts) {
    Wall wall;
    for (const std::string& host : hosts) {
        Tile& tile = wall.tiles.emplace_back();
        tile.name = fmt::format("tile-{}", wall.tiles.size() - 1);
        tile.host = host;
    }
    return wall;
}

using Shares = std::vector<std::vector<std::size_t>>;

Shares sharesOf(const std::vector<std::string>& tiles, const std::vector<std::string>& ranks) {
    const Result<Shares> shares = tilesOfRanks(wallOnHosts(tiles), ranks);
    EXPECT_TRUE(shares.ok()) << shares.error().message;
    return shares.ok() ? *shares : Shares();
}

std::string refusedShares(const std::vector<std::string>& tiles, const std::vector<std::string>& ranks) {
    const Result<Shares> shares = tilesOfRanks(wallOnHosts(tiles), ranks);
    return shares.ok() ? "" : shares.error().message;
}

TEST(TilesOfRanks, FollowHostsElseOrder) {
    EXPECT_EQ(sharesOf({"", "", ""}, {"a", "b", "c"}), (Shares{{0}, {1}, {2}}));
    EXPECT_EQ(sharesOf({"b", "a", "b"}, {"a", "b.lab.org", "b.lab.org"}), (Shares{{1}, {0}, {2}}));
    EXPECT_EQ(sharesOf({"", "a.x.org", ""}, {"b", "c", "a"}), (Shares{{0}, {2}, {1}}));
}

TEST(TilesOfRanks, AreContiguousAndAsEvenAsCanBe) {
    const std::vector<std::string> seven(7);
    EXPECT_EQ(sharesOf(seven, {"a"}), (Shares{{0, 1, 2, 3, 4, 5, 6}}));
    EXPECT_EQ(sharesOf(seven, {"a", "b"}), (Shares{{0, 1, 2}, {3, 4, 5, 6}}));
    EXPECT_EQ(sharesOf(seven, {"a", "a", "a"}), (Shares{{0, 1}, {2, 3}, {4, 5, 6}}));
    for (std::size_t ranks = 1; ranks <= 7; ++ranks) {
        std::size_t next = 0, least = 7, most = 0;
        for (const auto& share : sharesOf(seven, std::vector<std::string>(ranks, "a"))) {
            for (const std::size_t tile : share) EXPECT_EQ(tile, next++);
            least = std::min(least, share.size()), most = std::max(most, share.size());
        }
        EXPECT_EQ(next, 7u);
        EXPECT_LE(most, least + 1);
    }
}

TEST(TilesOfRanks, OfAHostAreSharedByItsRanks) {
    const std::vector<std::string> wanted{"a", "b", "a", "b.x.org", "a", "b", "a"};
    EXPECT_EQ(sharesOf(wanted, {"b", "a"}), (Shares{{1, 3, 5}, {0, 2, 4, 6}}));
    EXPECT_EQ(sharesOf(wanted, {"b", "a", "b"}), (Shares{{1}, {0, 2, 4, 6}, {3, 5}}));
    EXPECT_EQ(sharesOf(wanted, {"a", "b", "a", "a"}), (Shares{{0}, {1, 3, 5}, {2}, {4, 6}}));
}

TEST(TilesOfRanks, WithoutHostGoToRanksThatAreLeftElseToAll) {
    const std::vector<std::string> wanted{"", "a", "", "a", ""};
    EXPECT_EQ(sharesOf(wanted, {"a", "b"}), (Shares{{1, 3}, {0, 2, 4}}));
    EXPECT_EQ(sharesOf(wanted, {"c", "a", "b"}), (Shares{{0}, {1, 3}, {2, 4}}));
    EXPECT_EQ(sharesOf(wanted, {"a", "a", "a"}), (Shares{{1}, {3}, {0, 2, 4}}));
    EXPECT_EQ(sharesOf(wanted, {"a", "a"}), (Shares{{0, 1}, {2, 3, 4}}));
    EXPECT_EQ(sharesOf(wanted, {"a"}), (Shares{{0, 1, 2, 3, 4}}));
}

TEST(TilesOfRanks, ErrorsNameHosts) {
    EXPECT_EQ(refusedShares({"a", "b", "b"}, {"a", "a"}),
              "the wall file wants tile 'tile-1' on host 'b', where no rank is (ranks: 2 on a): see mpirun's "
              "--hostfile");
    EXPECT_EQ(
        refusedShares({"a", "b", "b"}, {"b", "a", "a"}),
        "the wall file has no tile for rank 2 on host 'a' (ranks: 2 on a, 1 on b): start fewer there, see "
        "mpirun's --hostfile");
    EXPECT_NE(refusedShares({"a", ""}, {"b", "b"}), "");
    EXPECT_NE(refusedShares({"a.x.org"}, {"a.y.org"}), "");
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
