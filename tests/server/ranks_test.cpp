// A rank that draws several tiles: the pictures of a rank for each, from one cache.

#include <algorithm>
#include <set>

#include "tests/server/flight.hpp"
#include "tests/server/render_fixture.hpp"
#include "tests/server/wall_renders.hpp"

namespace iwalk::tools {
namespace {

class RanksTest : public RenderTest {
  protected:
    static Settings settings(Mode mode, OcclusionTest occlusion = OcclusionTest::hzb) {
        Settings settings;
        settings.mode = mode;
        settings.occlusion = occlusion;
        settings.plpBudget = 1500;
        return settings;
    }
    // Some of what hides and is hidden.
    Dataset spheres() {
        Triangles all;
        for (int i = 0; i < 3; ++i) {
            const Triangles one = moved(sphere(1.0 - 0.3 * i, 4), {0.2 * i, 0.9 * i, 0});
            all.insert(all.end(), one.begin(), one.end());
        }
        return build(all, {}, 100);
    }
};

TEST_F(RanksTest, DrawTheSamePicturesHoweverFewTheyAre) {
    const Dataset dataset = spheres();
    const Wall wall = wallOf(300, 220, 2, 2);
    const std::vector<Camera> path = flight(dataset.manifest.bounds, 8, {0, 0, 1});
    std::vector<Settings> all{settings(Mode::frustum), settings(Mode::plp), settings(Mode::cplp),
                              settings(Mode::cplp, OcclusionTest::queries), settings(Mode::frustum)};
    all.back().cacheBytes = 64 << 10;  // not enough for a tile
    for (Settings& s : all) {
        WallServers each(dataset, wall, s, 0);
        std::vector<Picture> pictures;
        std::uint64_t hidden = 0;
        for (const Camera& camera : path) {
            pictures.push_back(each.draw(camera));
            hidden += each.stats().hiddenRanges;
        }
        EXPECT_EQ(hidden > 0, s.mode != Mode::frustum);
        for (const std::size_t ranks : {1, 2, 3}) {
            WallServers fewer(dataset, wall, s, 0, ranks);
            for (std::size_t i = 0; i < path.size(); ++i) {
                const Picture picture = fewer.draw(path[i]);
                EXPECT_EQ(picture.color.pixels, pictures[i].color.pixels) << ranks << " ranks, frame " << i;
                EXPECT_EQ(picture.depth.pixels, pictures[i].depth.pixels) << ranks << " ranks, frame " << i;
            }
        }
    }
}

TEST_F(RanksTest, ReadOnceForAllTheirTiles) {
    const Dataset dataset = spheres();
    Wall wall = wallOf(200, 150, 1, 1);
    wall.tiles.assign(3, Tile(wall.tiles[0]));  // the same pixels three times
    const Camera camera{{0.3, -4, 1}, {0, 0, 0}, {0, 0, 1}, 40};
    for (const Mode mode : {Mode::frustum, Mode::plp, Mode::cplp}) {
        WallServers servers(dataset, wall, settings(mode), 0, 1);
        servers.drawOnly(camera);
        const std::vector<protocol::TileStats>& tiles = servers.tileStats();
        ASSERT_EQ(tiles.size(), 3u);
        for (std::uint32_t i = 0; i < 3; ++i) {
            EXPECT_EQ(tiles[i].tile, i);
            EXPECT_EQ(tiles[i].triangles, tiles[0].triangles);
            EXPECT_EQ(tiles[i].fetchedBytes > 0, i == 0);
        }
    }
}

// Two tiles that see different halves of a model of which the cache holds little more than one: looking back
// and forth, each takes the other's memory. Caches of their own would hold all.
TEST_F(RanksTest, HaveOneCacheForAllTheirTiles) {
    const Dataset dataset = spheres();
    std::set<std::uint32_t> pages;
    for (const std::uint32_t entry : cutAtLevel(dataset.hierarchy, kFullLevel).entry)
        if (entry != Cut::kNothing) pages.insert(dataset.hierarchy.entries[entry].firstPage);
    std::uint64_t bytes = 0;
    for (const std::uint32_t page : pages) bytes += pageLayout(dataset.hierarchy.pages[page]).bytes;
    Settings some = settings(Mode::frustum);
    some.cacheBytes = bytes * 3 / 4;
    const Wall wall = wallOf(300, 220, 2, 1);
    const Camera camera{{0.2, -5, 1}, {0.2, 0.9, 0}, {0, 0, 1}, 40};
    const auto readAgain = [&](std::size_t ranks) {
        WallServers servers(dataset, wall, some, 0, ranks);
        servers.drawOnly(camera);
        servers.drawOnly(camera);
        return servers.stats().fetchedBytes;
    };
    EXPECT_EQ(readAgain(2), 0u);
    EXPECT_GT(readAgain(1), 0u);
}

TEST_F(RanksTest, TakeOverSettingsForAllTheirTiles) {
    const Dataset dataset = spheres();
    const Wall wall = wallOf(200, 150, 2, 1);
    const auto draw = [&](RankTiles& tiles) {
        FrameState state;
        state.eye[1] = -4, state.up[2] = 1, state.fovY = 40, state.near = 0.001;
        std::vector<std::vector<std::uint8_t>> pictures;
        for (std::size_t i = 0; i < tiles.size(); ++i) {
            tiles[i].draw(state);
            pictures.push_back(tiles[i].pixels().readColor().pixels);
        }
        return pictures;
    };
    Settings overdraw = settings(Mode::frustum), birdsEye = settings(Mode::cplp);
    overdraw.show = Show::overdraw;
    birdsEye.show = Show::birdseye;
    const auto changing = RankTiles::create(dataset, wall, {0, 1}, settings(Mode::cplp)).value();
    for (const Settings& next : {overdraw, birdsEye, settings(Mode::plp), settings(Mode::cplp)}) {
        draw(*changing);
        ASSERT_TRUE(changing->apply(next).ok());
        const auto fresh = RankTiles::create(dataset, wall, {0, 1}, next).value();
        // The second frame: --show birdseye has read everything.
        for (RankTiles* tiles : {changing.get(), fresh.get()}) draw(*tiles);
        EXPECT_TRUE(draw(*changing) == draw(*fresh))
            << settingText(next, "show") << ' ' << settingText(next, "mode");
    }
}

}  // namespace
}  // namespace iwalk::tools
