// What reaches the eye: projectors' light adds up, windows join swap groups together, ranks share GPUs.

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/file.hpp"
#include "server/draw/gl_objects.hpp"
#include "server/present/patterns.hpp"
#include "server/present/swap_group.hpp"
#include "server/present/tile_output.hpp"
#include "tests/server/render_fixture.hpp"

namespace iwalk {
namespace {

using namespace tools;

Wall wallFrom(const std::string& text) {
    const TempDirectory directory;
    const std::string path = directory.path("wall.toml");
    EXPECT_TRUE(replaceFile(path, text).ok());
    return loadWall(path).value();
}

Wall projectors(double gamma) {
    return wallFrom(fmt::format(
        "[wall]\nrows = 2\ncolumns = 3\ntile_px = [100, 60]\noverlap_px = [50, 17]\ngamma = {}\n", gamma));
}

// Every value in every part of the ramps.
ColorImage noise(const Wall& wall) {
    ColorImage picture(wall.width, wall.height, 3);
    std::mt19937 random(3);
    for (std::uint8_t& value : picture.pixels) value = static_cast<std::uint8_t>(random());
    return picture;
}

ColorImage cut(const ColorImage& picture, const PixelRect& rect) {
    ColorImage part(rect.width, rect.height, 3);
    for (int y = 0; y < rect.height; ++y)
        std::copy_n(picture.at(rect.x, rect.y + y), 3 * rect.width, part.at(0, y));
    return part;
}

ColorImage shownBy(const Tile& tile, const ColorImage& drawn) {
    const GLuint texture = makeTexture(GL_RGBA8, drawn.width, drawn.height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture, 0, 0, 0, drawn.width, drawn.height, GL_RGB, GL_UNSIGNED_BYTE,
                        drawn.pixels.data());
    const std::unique_ptr<TileOutput> output = TileOutput::create(tile, nullptr).value();
    output->prepare(texture);
    output->show();
    ColorImage shown = output->read();
    glDeleteTextures(1, &texture);
    return shown;
}

// The light that falls on each pixel of the wall, for each colour.
Image<double> lightOf(const Wall& wall, const ColorImage& picture) {
    Image<double> light(wall.width, wall.height, 3);
    for (const Tile& tile : wall.tiles) {
        const ColorImage shown = shownBy(tile, cut(picture, tile.onWall));
        for (int y = 0; y < shown.height; ++y)
            for (int i = 0; i < 3 * shown.width; ++i)
                light.at(tile.onWall.x, tile.onWall.y + y)[i] +=
                    std::pow(shown.at(0, y)[i] / 255.0, tile.blend.gamma);
    }
    return light;
}

using WallOutputTest = RenderTest;

TEST_F(WallOutputTest, ProjectorsLightAddsUpToThePicture) {
    for (const double gamma : {1.0, 1.8, 2.2, 3.0}) {
        const Wall wall = projectors(gamma);
        for (const bool white : {false, true}) {
            ColorImage picture = noise(wall);
            if (white) std::fill(picture.pixels.begin(), picture.pixels.end(), std::uint8_t{255});
            const Image<double> light = lightOf(wall, picture);
            double worst = 0;
            for (std::size_t i = 0; i < light.pixels.size(); ++i)
                worst =
                    std::max(worst, std::abs(light.pixels[i] - std::pow(picture.pixels[i] / 255.0, gamma)));
            EXPECT_LT(worst * 255, 1) << "gamma " << gamma << (white ? ", white" : ", noise");
        }
    }
}

TEST_F(WallOutputTest, RampsGrowFromTheEdge) {
    const Wall wall = projectors(1);
    ColorImage white(100, 60, 3);
    std::fill(white.pixels.begin(), white.pixels.end(), std::uint8_t{255});
    const ColorImage shown = shownBy(wall.tiles[0], white);  // with neighbours to the right and below
    EXPECT_EQ(*shown.at(0, 0), 255);
    EXPECT_EQ(*shown.at(49, 42), 255);
    for (int x = 50; x < 100; ++x) EXPECT_NEAR(*shown.at(x, 0), 255 * (1 - (x - 49.5) / 50), 1) << x;
    EXPECT_NEAR(*shown.at(0, 59), 255 * 0.5 / 17, 1);
}

TEST_F(WallOutputTest, WithoutNeighboursNothingIsDimmed) {
    Wall wall = projectors(2.2);
    const ColorImage drawn = cut(noise(wall), wall.tiles[0].onWall);
    wall.tiles[0].blend = {};
    EXPECT_EQ(shownBy(wall.tiles[0], drawn).pixels, drawn.pixels);
}

// In an overlap neighbours show the same lines, so that a person sees when projectors are off.
TEST_F(WallOutputTest, GridsOfNeighboursCoincide) {
    const Wall wall =
        wallFrom("[wall]\nrows = 1\ncolumns = 2\ntile_px = [640, 480]\noverlap_px = [100, 0]\n");
    const ColorImage left = drawPattern(Pattern::grid, wall, 0, {}),
                     right = drawPattern(Pattern::grid, wall, 1, {});
    int same = 0, all = 0, lit = 0;
    for (int y = 3; y < 477; ++y)  // inside the tiles' own frames
        for (int x = 543; x < 637; ++x, ++all) {
            same += std::equal(left.at(x, y), left.at(x, y) + 3, right.at(x - 540, y));
            lit += *left.at(x, y) > 0;
        }
    EXPECT_GT(lit, 1000);
    EXPECT_EQ(same, all);
}

class FakeDriver : public SwapGroupDriver {
  public:
    explicit FakeDriver(bool able) : able_(able) {}
    bool join() override { return ++joined, able_; }
    void leave() override { ++left; }
    int joined = 0, left = 0;

  private:
    const bool able_;
};

TEST(SwapGroup, AllJoinOrNone) {
    FakeDriver able(true), unable(false);
    bool said = true;
    const auto yes = [&](bool mine) { return said = mine; };
    const auto othersCannot = [](bool) { return false; };
    {
        const SwapGroup group(&able, yes);
        EXPECT_TRUE(group.joined());
        EXPECT_EQ(able.left, 0);
    }
    EXPECT_EQ(able.left, 1);
    EXPECT_FALSE(SwapGroup(&able, othersCannot).joined());
    EXPECT_EQ(able.joined, 2);
    EXPECT_EQ(able.left, 2);
    EXPECT_FALSE(SwapGroup(&unable, yes).joined());
    EXPECT_FALSE(said);
    EXPECT_EQ(unable.left, 0);  // it never was in
    EXPECT_FALSE(SwapGroup(nullptr, yes).joined());
    EXPECT_FALSE(said);
}

TEST(WallWindows, DisplaysAreKnownByTheirWholeNames) {
    EXPECT_EQ(wholeDisplayName(":0"), ":0.0");
    EXPECT_EQ(wholeDisplayName(":0.1"), ":0.1");
    EXPECT_EQ(wholeDisplayName("left.lab.org:2"), "left.lab.org:2.0");
    EXPECT_EQ(wholeDisplayName("none"), "none");
}

TEST(GlContext, RanksShareGpusInTurn) {
    using Order = std::vector<std::size_t>;
    EXPECT_EQ(deviceOrder({true, true, false}, 0), (Order{0, 1, 2}));
    EXPECT_EQ(deviceOrder({true, true, false}, 1), (Order{1, 0, 2}));
    EXPECT_EQ(deviceOrder({false, true, true}, 3), (Order{2, 1, 0}));
    EXPECT_EQ(deviceOrder({false}, 5), (Order{0}));
    EXPECT_EQ(deviceOrder({}, 5), Order());
}

}  // namespace
}  // namespace iwalk
