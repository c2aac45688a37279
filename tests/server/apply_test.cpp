// Settings that change from frame to frame, and what frames tell clients of their pixels.
#include <cmath>
#include <set>
#include <string>

#include "tests/server/render_fixture.hpp"
#include "tests/server/wall_renders.hpp"

namespace iwalk::tools {
namespace {

FrameState stateOf(const Camera& camera) {
    FrameState state;
    const auto copy = [](const glm::dvec3& from, double(&to)[3]) {
        for (std::size_t i = 0; i < 3; ++i) to[i] = from[i];
    };
    copy(camera.eye, state.eye), copy(camera.target, state.target), copy(camera.up, state.up);
    state.fovY = camera.fovY;
    state.near = 0.001;
    return state;
}

class ApplyTest : public RenderTest {
  protected:
    std::unique_ptr<RankTiles> tiles(const Dataset& dataset, const Settings& settings) {
        auto made = RankTiles::create(dataset, wall_, {0}, settings);
        EXPECT_TRUE(made.ok()) << made.error().message;
        return std::move(made).value();
    }
    ColorImage draw(RankTiles& tiles) {
        stats_ = tiles[0].draw(stateOf(camera_));
        return tiles[0].pixels().readColor();
    }

    const Wall wall_ = wallOf(200, 150, 1, 1);
    Camera camera_{{0.3, -4, 1}, {0, 0, 0}, {0, 0, 1}, 40};
    protocol::TileStats stats_;
};

TEST_F(ApplyTest, IsAsIfTheServersHadBegunWithThem) {
    const Dataset dataset = build(sphere(1, 6));
    std::vector<Settings> all(9);
    all[1].show = Show::overdraw;
    all[1].mode = Mode::frustum;
    all[2].level = 0;
    all[3].show = Show::levels;
    all[4].mode = Mode::plp;
    all[4].plpBudget = 2000;
    all[5].mode = Mode::plp;
    all[6].occlusion = OcclusionTest::queries;
    all[6].background = 0xff8000;
    all[7].show = Show::overdraw;
    all[7].mode = Mode::frustum;
    all[8].shading = Shading::flat;
    all[8].ramp = Ramp::none;

    const auto only = tiles(dataset, all[0]);
    std::set<std::string> pictures;
    for (const Settings& settings : all) {
        ASSERT_TRUE(only->apply(settings).ok());
        const ColorImage changed = draw(*only);
        EXPECT_EQ(changed.pixels, draw(*only).pixels);  // and stays so
        EXPECT_EQ(changed.pixels, draw(*tiles(dataset, settings)).pixels);
        pictures.emplace(changed.pixels.begin(), changed.pixels.end());
    }
    EXPECT_GE(pictures.size(), 6u);
}

TEST_F(ApplyTest, DepthsAreDistancesAlongTheView) {
    const Dataset dataset = build({{glm::dvec3(-9, 0, -9), glm::dvec3(9, 0, -9), glm::dvec3(0, 0, 9)}});
    for (const Mode mode : {Mode::frustum, Mode::plp, Mode::cplp}) {
        Settings settings;
        settings.mode = mode;
        const auto only = tiles(dataset, settings);
        camera_ = {{0, -4, 0}, {0, 0, 0}, {0, 0, 1}, 40};
        draw(*only);
        EXPECT_NEAR(stats_.nearDepth, 4, 1e-3);
        EXPECT_NEAR(stats_.midDepth, 4, 1e-3);
        camera_ = {{0, -4, 0}, {4, 0, 0}, {0, 0, 1}, 40};  // slanting: from some 3 units on
        draw(*only);
        EXPECT_LT(stats_.nearDepth, 4.8);
        EXPECT_GT(stats_.midDepth, stats_.nearDepth);
        camera_ = {{0, -4, 0}, {0, -8, 0}, {0, 0, 1}, 40};  // away from it
        draw(*only);
        EXPECT_EQ(stats_.nearDepth, 0);
        EXPECT_EQ(stats_.midDepth, 0);
    }
}

TEST_F(ApplyTest, SmallPicturesAreMeansOfLargeOnes) {
    const Dataset dataset = build(sphere(1, 5));
    const auto only = tiles(dataset, {});
    const ColorImage large = draw(*only);
    for (const auto& [width, height] :
         {std::pair(50, 38), std::pair(13, 9), std::pair(200, 150), std::pair(1, 1)}) {
        const ColorImage small = (*only)[0].pixels().readSmall(width, height);
        ASSERT_EQ(small.width, width);
        ASSERT_EQ(small.height, height);
        double off = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                double sum = 0, count = 0;
                for (int v = y * 150 / height; v < std::max((y + 1) * 150 / height, y * 150 / height + 1);
                     ++v)
                    for (int u = x * 200 / width; u < std::max((x + 1) * 200 / width, x * 200 / width + 1);
                         ++u)
                        sum += large.at(u, v)[1], ++count;
                off += std::abs(sum / count - small.at(x, y)[1]);
            }
        }
        EXPECT_LT(off / (width * height), 12) << width;
    }
    const ColorImage most = (*only)[0].pixels().readSmall(5000, 5000);
    EXPECT_EQ(most.pixels, large.pixels);
}

}  // namespace
}  // namespace iwalk::tools
