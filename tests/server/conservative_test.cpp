// Conservative visibility must not change a bit of the picture, whatever is hard about the scene.

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/server/flight.hpp"
#include "tests/server/render_fixture.hpp"
#include "tests/server/wall_renders.hpp"

namespace iwalk::tools {
namespace {

struct Totals {
    std::uint64_t pixels = 0, triangles = 0, hidden = 0, looks = 0, allTriangles = 0;
};

class ConservativeTest : public RenderTest, public ::testing::WithParamInterface<const char*> {
  protected:
    Settings settings(const char* mode, const char* near = "0") const {
        Settings settings;
        EXPECT_TRUE(setSetting(settings, "mode", mode).ok());
        EXPECT_TRUE(setSetting(settings, "occlusion", GetParam()).ok());
        EXPECT_TRUE(setSetting(settings, "near", near).ok());
        return settings;
    }
    // Flies with and without and compares frame by frame, one picture against tiles.
    Totals expectSame(const Dataset& dataset, const std::vector<Camera>& path, const Settings& cplp,
                      int columns = 1, double costOfLooking = 0) {
        Settings frustum = cplp;
        frustum.mode = Mode::frustum;
        const Wall one = wallOf(320, 240, 1, 1), tiles = wallOf(320, 240, columns, columns);
        WallServers all(dataset, one, frustum), some(dataset, tiles, cplp, costOfLooking);
        Totals totals;
        for (std::size_t i = 0; i < path.size(); ++i) {
            const Picture picture = all.draw(path[i]);
            const Comparison comparison = compare(picture, some.draw(path[i]), std::nullopt);
            EXPECT_EQ(comparison.different, 0u) << "frame " << i;
            totals.pixels += static_cast<std::uint64_t>(
                std::ranges::count_if(picture.depth.pixels, [](float z) { return z > 0; }));
            totals.allTriangles += all.stats().triangles;
            totals.triangles += some.stats().triangles;
            totals.hidden += some.stats().hiddenPages + some.stats().hiddenRanges;
            totals.looks += some.stats().pyramidMs > 0;
        }
        EXPECT_GT(totals.pixels, path.size() * 100);
        return totals;
    }
};

void add(Triangles& to, const Triangles& more) {
    to.insert(to.end(), more.begin(), more.end());
}

// Towards +x, drifting a little.
std::vector<Camera> drift(const glm::dvec3& from, const glm::dvec3& step, int frames, double fov = 60) {
    std::vector<Camera> path;
    for (int i = 0; i < frames; ++i) {
        const glm::dvec3 eye = from + static_cast<double>(i) * step;
        path.push_back({eye, eye + glm::dvec3(1, 0.03, 0.02), {0, 0, 1}, fov});
    }
    return path;
}

TEST_P(ConservativeTest, AWallHidesWhatIsBehindIt) {
    Triangles triangles = wallAt(0, 4, 24);
    for (int i = 0; i < 12; ++i) add(triangles, moved(sphere(0.5, 4), {2.0 + i, 0.2 * i - 1, 0.1 * i}));
    const Totals totals =
        expectSame(build(triangles), drift({-3, 0, 0}, {0.1, 0.02, 0}, 5), settings("cplp"), 2);
    EXPECT_GT(totals.hidden, 0u);
    EXPECT_LT(totals.triangles, totals.allTriangles / 2);
}

TEST_P(ConservativeTest, TheEyeInABoxAndAtTheNearPlane) {
    Triangles triangles = sphere(1, 5);
    add(triangles, wallAt(2, 6, 30));
    add(triangles, moved(sphere(0.7, 4), {4, 0, 0}));
    const Dataset dataset = build(triangles);
    expectSame(dataset, drift({-1.5, 0.1, 0}, {0.25, 0, 0.01}, 14), settings("cplp", "0.3"));
    expectSame(dataset, drift({0.9, 0.1, 0}, {0.02, 0, 0.01}, 10), settings("cplp"));
}

// Bars whose gaps are less than a pixel, in front of something large and of something bright.
TEST_P(ConservativeTest, GapsThinnerThanAPixel) {
    PlyOptions options;
    Triangles triangles;
    for (int i = -300; i < 300; ++i)
        add(triangles, moved(box({0, -0.0024, -3}, {0.01, 0.0024, 3}), {0, 0.005 * i, 0}));
    options.colors.assign(triangles.size(), {20, 20, 20});
    for (int i = 0; i < 6; ++i) add(triangles, moved(sphere(0.6, 4), {2.0 + i, 0.3 * i - 0.8, 0.5}));
    options.colors.resize(triangles.size(), {255, 255, 0});
    expectSame(build(triangles, options), drift({-2, 0, 0}, {0.02, 0.0013, 0.0007}, 12), settings("cplp"), 2);
}

// A hole of two pixels in a wall, and a needle behind it, far away.
TEST_P(ConservativeTest, ANeedleThroughAKeyhole) {
    Triangles triangles = boxWithWindow({-1, -1, -1}, {1, 1, 1}, {-0.02, -0.02}, {0.02, 0.02});
    for (int i = 0; i < 200; ++i) {
        const double x = 0.001 * (i - 100);
        triangles.push_back({glm::dvec3(x, -2, -9 - 0.01 * i), {x + 0.0004, -2, -9}, {x, 2, -9}});
    }
    add(triangles, moved(sphere(1, 5), {0, 0, -14}));
    std::vector<Camera> path;
    for (int i = 0; i < 12; ++i) path.push_back({{0.002 * i, 0.001 * i, 4}, {0, 0, 0}, {0, 1, 0}, 60});
    add(triangles, wallAt(3, 3, 20));
    expectSame(build(triangles), path, settings("cplp"));
}

// Surfaces that are twice there, in pages of their own and in other colours: which of two equal depths is
// seen must not depend on what was drawn first.
TEST_P(ConservativeTest, CoincidentFaces) {
    PlyOptions options;
    Triangles triangles;
    for (int copy = 0; copy < 5; ++copy) {
        add(triangles, wallAt(0, 2, 20 + 3 * copy));
        add(triangles, sphere(1, 4));
        options.colors.resize(triangles.size(), {static_cast<std::uint8_t>(60 * copy), 90,
                                                 static_cast<std::uint8_t>(255 - 50 * copy)});
    }
    for (int i = 0; i < 5; ++i) add(triangles, moved(sphere(0.5, 4), {3.0 + i, 0, 0}));
    options.colors.resize(triangles.size(), {250, 250, 250});
    std::vector<Camera> path = drift({-3, 0, 0}, {0.05, 0.1, 0.02}, 8);
    path.push_back({{5, -4, 2}, {0, 0, 0}, {0, 0, 1}, 50});
    path.push_back({{5, -4.1, 2}, {0, 0, 0}, {0, 0, 1}, 50});
    expectSame(build(triangles, options), path, settings("cplp"), 2);
}

// Rasterisers interpolate the depth of such needles far in front of their corners. These begin just behind a
// wall, so that little is enough to come through it.
TEST_P(ConservativeTest, SliversEdgeOnBehindAWall) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> number(-1, 1);
    const glm::dvec3 eye(-3, 0, 0);
    const auto onRay = [&](double y, double z, double x) { return eye + (x + 3) * glm::dvec3(1, y, z); };
    PlyOptions options;
    Triangles triangles = wallAt(0, 3, 16);
    options.colors.assign(triangles.size(), {100, 100, 100});
    for (int i = 0; i < 10000; ++i) {
        const double y = 0.5 * number(random), z = 0.4 * number(random), toY = 0.5 * number(random),
                     toZ = 0.4 * number(random);
        const double along = 0.5 + 0.5 * number(random);
        triangles.push_back({onRay(y, z, 0.002), onRay(toY, toZ, 0.002),
                             onRay(std::lerp(y, toY, along), std::lerp(z, toZ, along), 3)});
    }
    options.colors.resize(triangles.size(), {255, 0, 0});
    options.doubles = true;
    std::vector<Camera> path;  // straight at the wall, lest the corners of boxes come before it
    for (int i = 0; i < 4; ++i) path.push_back({eye + glm::dvec3(1e-4 * i, 0, 0), {0, 0, 0}, {0, 0, 1}, 60});
    const Totals totals = expectSame(build(triangles, options), path, settings("cplp"));
    EXPECT_GT(totals.hidden, 0u);
}

TEST_P(ConservativeTest, ATriangleAcrossTheScreen) {
    Triangles triangles{{glm::dvec3(0, -500, -300), {0.5, 500, -300}, {0, 0, 600}}};
    add(triangles, {{glm::dvec3(-40, -500, -2), {90, 500, -2.2}, {700, 0, -2.1}}});
    for (int i = 0; i < 6; ++i) add(triangles, moved(sphere(0.8, 4), {1.5 * i - 3, 0.3, 0.2 * i}));
    expectSame(build(triangles), drift({-6, 0, 0}, {0.5, 0.05, 0.02}, 14), settings("cplp"), 3);
}

TEST_P(ConservativeTest, ACacheThatHoldsAlmostNothing) {
    Triangles triangles = wallAt(0, 2, 40);
    add(triangles, sphere(1, 5));
    for (int i = 0; i < 12; ++i) add(triangles, moved(sphere(0.5, 4), {2.0 + i, 0.3 * i - 1, 0.3 * i}));
    Settings tight = settings("cplp");
    tight.cacheBytes = 128 << 10;
    expectSame(build(triangles), drift({-4, 0, 0}, {0.2, 0.1, 0.1}, 6), tight);
}

TEST_P(ConservativeTest, FlyingThroughTheSample) {
    const Dataset dataset = buildFile(std::string(IWALK_CONFIG_DIR) + "/sample/interior.ply");
    const Totals totals =
        expectSame(dataset, flight(dataset.manifest.bounds, 16, {0, 0, 1}), settings("cplp"), 2);
    EXPECT_GT(totals.hidden, 0u);
}

// What of the model must be hidden for looking to pay, as a share of all its triangles.
double costOf(const Triangles& triangles, double share) {
    return share * static_cast<double>(triangles.size()) / (320 * 240);
}

TEST_P(ConservativeTest, LooksWhereMuchIsHidden) {
    Triangles triangles = wallAt(0, 4, 24);
    for (int i = 0; i < 12; ++i) add(triangles, moved(sphere(0.5, 4), {2.0 + i, 0.2 * i - 1, 0.1 * i}));
    const Dataset dataset = build(triangles);
    const std::vector<Camera> path = drift({-3, 0, 0}, {0.02, 0.02, 0}, 6);
    EXPECT_EQ(expectSame(dataset, path, settings("cplp"), 1, costOf(triangles, 0.3)).looks, path.size());
    EXPECT_EQ(expectSame(dataset, path, settings("cplp"), 1, costOf(triangles, 1.01)).looks, 0u);
}

TEST_P(ConservativeTest, LooksNowAndThenWhereNothingIsHidden) {
    const Triangles triangles = wallAt(0, 1.5, 40);
    const Totals totals = expectSame(build(triangles), drift({-3, 0, 0}, {0.001, 0, 0}, 20), settings("cplp"),
                                     1, costOf(triangles, 0.3));
    EXPECT_EQ(totals.looks, 4u);  // in frames 0, 3, 8, 17
    EXPECT_EQ(totals.triangles, totals.allTriangles);
}

INSTANTIATE_TEST_SUITE_P(Occlusion, ConservativeTest, ::testing::Values("hzb", "queries"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace iwalk::tools
