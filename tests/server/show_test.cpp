// What `--show` paints.
#include <algorithm>
#include <set>

#include "tests/server/render_fixture.hpp"
#include "tests/server/wall_renders.hpp"

namespace iwalk::tools {
namespace {

using Color = std::array<std::uint8_t, 3>;

// Of the pixels that show a surface.
std::set<Color> colorsIn(const Picture& picture) {
    std::set<Color> colors;
    for (int y = 0; y < picture.color.height; ++y) {
        for (int x = 0; x < picture.color.width; ++x) {
            const std::uint8_t* c = picture.color.at(x, y);
            if (*picture.depth.at(x, y) > 0) colors.insert({c[0], c[1], c[2]});
        }
    }
    return colors;
}

bool isRed(const Color& c) {
    return c[0] > 2 * c[1] && c[0] > 2 * c[2];
}
bool isGreen(const Color& c) {
    return c[1] > 2 * c[0] && c[1] > 2 * c[2];
}
bool isGrey(const Color& c) {
    return c[0] == c[1] && c[1] == c[2];
}

class ShowTest : public RenderTest {
  protected:
    // One behind the other, facing the camera.
    Triangles squares(int count) const {
        Triangles triangles;
        for (int i = 0; i < count; ++i) {
            const double z = -0.01 * i;
            const glm::dvec3 a(-1, -1, z), b(1, -1, z), c(1, 1, z), d(-1, 1, z);
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
        }
        return triangles;
    }
    static Settings showing(Show show) {
        Settings settings;
        settings.show = show;
        settings.mode = Mode::frustum;
        return settings;
    }
    const Camera camera_{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 10};  // sees the middle of the squares only
    const Camera outside_{{0, -4, 0}, {0, 0, 0}, {0, 0, 1}, 40};
    const Wall wall_ = wallOf(64, 64, 1, 1);
};

TEST_F(ShowTest, OverdrawCountsTriangles) {
    const auto colorOf = [&](int count) {
        const Dataset dataset = build(squares(count));
        WallRenders renders(dataset, showing(Show::overdraw));
        return *colorsIn(renders.draw(wall_, camera_)).begin();
    };
    const Color one = colorOf(1), some = colorOf(16), many = colorOf(250);
    EXPECT_GT(one[2], one[0]);                       // blue
    EXPECT_GT(some[1], std::max(some[0], some[2]));  // green
    EXPECT_GT(std::min({many[0], many[1], many[2]}), 200);
}

TEST_F(ShowTest, RangesHaveColorsOfTheirOwn) {
    const Dataset dataset = build(sphere(1, 5));
    EXPECT_GT(colorsIn(WallRenders(dataset, showing(Show::ranges)).draw(wall_, outside_)).size(), 10u);
}

TEST_F(ShowTest, LevelsRunFromBlueToRedAndFullIsGrey) {
    const Dataset dataset = build(sphere(1, 6));
    ASSERT_GE(dataset.manifest.levels.size(), 2u);
    Settings settings = showing(Show::levels);
    for (const Color& color : colorsIn(WallRenders(dataset, settings).draw(wall_, outside_)))
        EXPECT_TRUE(isGrey(color));
    settings.level = 0;
    for (const Color& color : colorsIn(WallRenders(dataset, settings).draw(wall_, outside_)))
        EXPECT_GT(color[2], std::max(color[0], color[1]));
}

TEST_F(ShowTest, TheCacheIsRedWhereItReadsAndThenGreen) {
    const Dataset dataset = build(sphere(1, 5));
    WallServers servers(dataset, wall_, showing(Show::cache));
    for (const Color& color : colorsIn(servers.draw(outside_))) EXPECT_TRUE(isRed(color));
    for (const Color& color : colorsIn(servers.draw(outside_))) EXPECT_TRUE(isGreen(color));
}

TEST_F(ShowTest, PrioritiesRunFromRedToBlueInModePlp) {
    const Dataset dataset = build(sphere(1, 5));
    Settings settings = showing(Show::priority);
    EXPECT_FALSE(RankTiles::create(dataset, wall_, {0}, settings).ok());
    settings.mode = Mode::plp;
    int red = 0, blue = 0;
    for (const Color& c : colorsIn(WallRenders(dataset, settings).draw(wall_, outside_))) {
        EXPECT_FALSE(isGrey(c));
        red += c[0] > std::max(c[1], c[2]);
        blue += c[2] > std::max(c[0], c[1]);
    }
    EXPECT_GT(red, 0);
    EXPECT_GT(blue, 0);
}

class BirdsEyeTest : public ShowTest {
  protected:
    // Pixels of exactly this colour: lines before all surfaces.
    static int count(const Picture& picture, const Color& color) {
        int pixels = 0;
        for (int y = 0; y < picture.color.height; ++y)
            for (int x = 0; x < picture.color.width; ++x)
                pixels += std::equal(color.begin(), color.end(), picture.color.at(x, y));
        return pixels;
    }
    static constexpr Color kDrawn{60, 200, 80}, kRead{230, 60, 50}, kLeftOut{80, 120, 230},
        kFrustum{255, 220, 60};
    const Wall large_ = wallOf(300, 300, 1, 1);
};

TEST_F(BirdsEyeTest, HasTheFrustumAndWhatWasReadAndDrawn) {
    const Dataset dataset = build(sphere(1, 5));
    WallServers servers(dataset, large_, showing(Show::birdseye));
    const Picture first = servers.draw(outside_), second = servers.draw(outside_);
    for (const Picture& picture : {first, second}) {
        EXPECT_GT(count(picture, kFrustum), 50);
        EXPECT_EQ(count(picture, kLeftOut), 0);
        EXPECT_GT(std::ranges::count_if(picture.depth.pixels, [](float z) { return z > 0; }), 3000);
    }
    EXPECT_GT(count(first, kRead), 50);
    EXPECT_EQ(count(first, kDrawn), 0);
    EXPECT_GT(count(second, kDrawn), 50);
    EXPECT_EQ(count(second, kRead), 0);
}

TEST_F(BirdsEyeTest, ShowsWhatIsHidden) {
    Triangles triangles = moved(box({-4, -0.1, -4}, {4, 0.1, 4}), {0, -2, 0});
    for (const double x : {-2, 0, 2}) {
        const Triangles more = moved(sphere(0.9, 4), {x, 3, 0});
        triangles.insert(triangles.end(), more.begin(), more.end());
    }
    const Dataset dataset = build(triangles);
    Settings settings = showing(Show::birdseye);
    EXPECT_EQ(count(WallServers(dataset, large_, settings).draw(outside_), kLeftOut), 0);
    settings.mode = Mode::cplp;
    EXPECT_GT(count(WallServers(dataset, large_, settings, 0).draw(outside_), kLeftOut), 50);
}

}  // namespace
}  // namespace iwalk::tools
