// What the servers draw, judged: against a ray caster on the CPU, and N tiles against one big render.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "preprocess/import/importer.hpp"
#include "tests/server/render_fixture.hpp"
#include "tests/server/wall_renders.hpp"
#include "tests/tools/depth_agreement.hpp"
#include "tests/tools/ray_caster.hpp"
#include "tests/tools/scenes.hpp"

namespace iwalk {
namespace {

using namespace tools;

// Pixels whose depth is within 1e-4 of the ray caster's, as a share of all.
double depthAgreementOf(const Dataset& dataset, const Triangles& triangles, const Camera& camera) {
    const Settings settings;
    const Picture picture = WallRenders(dataset, settings).draw(wallOf(320, 240, 1, 1), camera);
    const CastPicture cast =
        castPicture(RayCaster(triangles), camera, 320, 240, nearPlane(settings, dataset.manifest));
    const DepthAgreement agreement = depthAgreement(picture.depth, cast.depth, 1e-4);
    EXPECT_LT(agreement.missing + agreement.extra, agreement.pixels);
    return agreement.fraction();
}

// All triangles of an input file.
Triangles trianglesOf(const std::string& input, const std::string& spillDirectory) {
    Triangles triangles;
    Result<std::unique_ptr<Importer>> importer =
        openImporter(input, {std::uint64_t{64} << 20, spillDirectory});
    EXPECT_TRUE(importer.ok());
    EXPECT_TRUE((*importer)->scan([](auto) {}, [](double) {}).ok());
    const TriangleSink sink = [&](std::span<const iwalk::Triangle> batch) {
        for (const iwalk::Triangle& t : batch)
            triangles.push_back({t[0].position, t[1].position, t[2].position});
        return Result<void>();
    };
    EXPECT_TRUE((*importer)->triangles(sink, [](double) {}).ok());
    return triangles;
}

// Crossing triangles of all sizes and colours around the origin: the hardest case for tiles that must agree.
Triangles soup(int count, PlyOptions& options) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-1, 1), size(-3, 0);
    Triangles triangles;
    for (int i = 0; i < count; ++i) {
        const double scale = std::pow(10, size(random));
        tools::Triangle triangle;
        const glm::dvec3 centre(place(random), place(random), place(random));
        for (glm::dvec3& corner : triangle)
            corner = centre + scale * glm::dvec3(place(random), place(random), place(random));
        triangles.push_back(triangle);
        options.colors.push_back({static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                                  static_cast<std::uint8_t>(random())});
    }
    return triangles;
}

// To the last bit of colour and depth. The pictures show something.
void expectSame(const Picture& one, const Picture& other) {
    const auto seen =
        std::count_if(one.depth.pixels.begin(), one.depth.pixels.end(), [](float z) { return z > 0; });
    EXPECT_GT(seen, static_cast<std::ptrdiff_t>(one.depth.pixels.size() / 10));
    const Comparison comparison = compare(one, other, std::nullopt);
    EXPECT_EQ(comparison.different, 0u);
}

const Camera kOutside{{2.2, -2.6, 1.4}, {0, 0, 0}, {0, 0, 1}, 45};
const Camera kInside{{0.1, 0.2, -0.1}, {1, 0.4, 0.2}, {0, 0, 1}, 75};

TEST_F(RenderTest, SphereHasTheRightDepths) {
    const Triangles triangles = sphere(1, 5);
    const Dataset dataset = build(triangles);
    EXPECT_GT(dataset.hierarchy.pages.size(), 8u);
    for (const Camera& camera : {kOutside, kInside})
        EXPECT_GE(depthAgreementOf(dataset, triangles, camera), 0.999);
}

TEST_F(RenderTest, BoxWithAWindowHasTheRightDepths) {
    const Triangles triangles = boxWithWindow({-1, -1, -1}, {1, 1, 1}, {-0.5, -0.3}, {0.4, 0.6});
    const Dataset dataset = build(triangles);
    const Camera throughWindow{{0.2, 0.1, 3}, {0, 0.1, 0}, {0, 1, 0}, 50};
    for (const Camera& camera : {kOutside, kInside, throughWindow})
        EXPECT_GE(depthAgreementOf(dataset, triangles, camera), 0.999);
}

TEST_F(RenderTest, FarFromTheOriginNothingShakes) {
    const glm::dvec3 far(1e7, -1e7, 1e7);
    const Triangles triangles = moved(sphere(1, 5), far);
    const Dataset dataset = build(triangles, {{}, true});
    for (Camera camera : {kOutside, kInside}) {
        camera.eye += far;
        camera.target += far;
        EXPECT_GE(depthAgreementOf(dataset, triangles, camera), 0.999);
    }
}

TEST_F(RenderTest, TheSampleHasTheRightDepths) {
    const std::string input = std::string(IWALK_CONFIG_DIR) + "/sample/interior.ply";
    const Dataset dataset = buildFile(input);
    const Result<std::vector<Camera>> views =
        loadCameraPath(std::string(IWALK_CONFIG_DIR) + "/sample/views.json");
    ASSERT_TRUE(views.ok()) << views.error().message;
    const Triangles triangles = trianglesOf(input, directory_.path(""));
    for (const Camera& camera : *views) EXPECT_GE(depthAgreementOf(dataset, triangles, camera), 0.999);
}

TEST_F(RenderTest, TilesOfTheSampleMakeOnePicture) {
    const Dataset dataset = buildFile(std::string(IWALK_CONFIG_DIR) + "/sample/interior.ply");
    const Result<std::vector<Camera>> views =
        loadCameraPath(std::string(IWALK_CONFIG_DIR) + "/sample/views.json");
    ASSERT_TRUE(views.ok()) << views.error().message;
    WallRenders renders(dataset, {});
    for (const Camera& camera : *views)
        expectSame(renders.draw(wallOf(804, 604, 1, 1), camera),
                   renders.draw(wallOf(804, 604, 4, 4), camera));
}

TEST_F(RenderTest, TilesOfCrossingTrianglesMakeOnePicture) {
    PlyOptions options;
    const Dataset dataset = build(soup(30000, options), options);
    WallRenders renders(dataset, {});
    for (const Camera& camera : {kOutside, kInside})
        expectSame(renders.draw(wallOf(801, 603, 1, 1), camera),
                   renders.draw(wallOf(801, 603, 4, 4), camera));
}

// No viewport is that wide: however the screen is cut, the pixels are the same.
TEST_F(RenderTest, ScreensWiderThanTheLargestViewportMakeOnePicture) {
    PlyOptions options;
    const Dataset dataset = build(soup(20000, options), options);
    WallRenders renders(dataset, {});
    Camera camera = kInside;
    camera.fovY = 2;
    expectSame(renders.draw(wallOf(20000, 60, 3, 1), camera), renders.draw(wallOf(20000, 60, 16, 1), camera));
}

TEST_F(RenderTest, CacheSizeAndThreadsDoNotChangeAPixel) {
    PlyOptions options;
    const Dataset dataset = build(soup(30000, options), options);
    const Wall wall = wallOf(640, 480, 1, 1);
    Settings roomy, tight;
    tight.cacheBytes = 128 << 10;
    tight.fetchThreads = 5;
    WallRenders all(dataset, roomy), batches(dataset, tight);
    const Comparison comparison = compare(all.draw(wall, kInside), batches.draw(wall, kInside), std::nullopt);
    EXPECT_EQ(comparison.different, 0u);
    EXPECT_EQ(all.stats().triangles, batches.stats().triangles);
}

TEST_F(RenderTest, PlpWithEnoughBudgetMissesNothing) {
    const Dataset dataset = buildFile(std::string(IWALK_CONFIG_DIR) + "/sample/interior.ply");
    const Result<std::vector<Camera>> views =
        loadCameraPath(std::string(IWALK_CONFIG_DIR) + "/sample/views.json");
    ASSERT_TRUE(views.ok()) << views.error().message;
    Settings plp;
    plp.mode = Mode::plp;
    plp.plpBudget = dataset.manifest.triangles;
    const Wall wall = wallOf(1100, 604, 2, 1);  // two blocks in a tile
    for (const Camera& camera : *views)
        expectSame(WallRenders(dataset, {}).draw(wall, camera), WallRenders(dataset, plp).draw(wall, camera));
}

// Nor does the cache, which holds less than the candidates, change what is chosen.
TEST_F(RenderTest, PlpKeepsItsBudgetWhateverTheCache) {
    PlyOptions options;
    const Dataset dataset = build(soup(30000, options), options);
    const Wall wall = wallOf(640, 480, 1, 1);
    Settings roomy, tight;
    roomy.mode = tight.mode = Mode::plp;
    roomy.plpBudget = tight.plpBudget = 4000;
    tight.cacheBytes = 128 << 10;
    WallRenders one(dataset, roomy), other(dataset, tight);
    expectSame(one.draw(wall, kInside), other.draw(wall, kInside));
    EXPECT_LE(one.stats().triangles, 4000u);
    EXPECT_GT(one.stats().triangles, 3400u);
}

TEST_F(RenderTest, FinerThanAllLevelsIsTheInput) {
    const Dataset dataset = build(sphere(1, 4));
    const Wall wall = wallOf(320, 240, 1, 1);
    Settings fine;
    fine.level = 100;
    expectSame(WallRenders(dataset, {}).draw(wall, kOutside),
               WallRenders(dataset, fine).draw(wall, kOutside));
}

TEST_F(RenderTest, EveryLevelDrawsTheModel) {
    const Dataset dataset = build(sphere(1, 6));
    const Wall wall = wallOf(320, 240, 1, 1);
    const auto covered = [](const Picture& picture) {
        return std::ranges::count_if(picture.depth.pixels, [](float depth) { return depth > 0; });
    };
    const auto full = covered(WallRenders(dataset, {}).draw(wall, kOutside));
    ASSERT_GE(dataset.manifest.levels.size(), 3u);
    for (std::size_t level = 0; level < dataset.manifest.levels.size(); ++level) {
        Settings settings;
        settings.level = static_cast<std::uint8_t>(level);
        WallRenders renders(dataset, settings);
        const auto here = covered(renders.draw(wall, kOutside));
        EXPECT_LT(std::abs(static_cast<double>(here - full)), 0.1 * static_cast<double>(full)) << level;
        EXPECT_LE(renders.stats().triangles, dataset.manifest.levels[level].triangles) << level;
    }
}

TEST_F(RenderTest, ACacheSmallerThanAPageIsRefused) {
    const Dataset dataset = build(sphere(1, 4));
    Settings settings;
    settings.cacheBytes = 1024;
    const Wall wall = wallOf(64, 64, 1, 1);
    const auto tiles = RankTiles::create(dataset, wall, {0}, settings);
    ASSERT_FALSE(tiles.ok());
    EXPECT_NE(tiles.error().message.find("--cache"), std::string::npos);
}

TEST_F(RenderTest, DrawsOnWithoutABrokenPage) {
    const Dataset dataset = build(sphere(1, 5));
    WallRenders renders(dataset, {});
    renders.draw(wallOf(320, 240, 1, 1), kOutside);
    const std::uint64_t whole = renders.stats().triangles;

    const PageRecord& page = dataset.hierarchy.pages[1];
    const std::string file = dataset.path + "/" + dataset.manifest.pageFiles[page.file].name;
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(static_cast<std::streamoff>(page.offset + page.bytes / 2));
    stream.put('\x5a');
    stream.close();
    renders.draw(wallOf(320, 240, 1, 1), kOutside);
    EXPECT_EQ(renders.stats().badPages, 1u);
    EXPECT_LT(renders.stats().triangles, whole);
    EXPECT_GT(renders.stats().triangles, 0u);
}

// A coarse sphere with a sphere's normals is shaded like a fine one.
TEST_F(RenderTest, NormalsOfTheInputMakeSmoothShading) {
    const Triangles coarse = sphere(1, 2);
    std::ofstream ply(directory_.path("smooth.ply"));
    ply << "ply\nformat ascii 1.0\nelement vertex " << 3 * coarse.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
           "property float nz\nelement face "
        << coarse.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const tools::Triangle& t : coarse)
        for (const glm::dvec3& p : t)
            ply << p.x << ' ' << p.y << ' ' << p.z << ' ' << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (std::size_t i = 0; i < coarse.size(); ++i)
        ply << "3 " << 3 * i << ' ' << 3 * i + 1 << ' ' << 3 * i + 2 << '\n';
    ply.close();
    const Dataset dataset = buildFile(directory_.path("smooth.ply"));
    Settings settings;
    settings.ramp = Ramp::none;
    const Camera ahead{{0, -5, 0}, {0, 0, 0}, {0, 0, 1}, 20};
    const Picture picture = WallRenders(dataset, settings).draw(wallOf(200, 200, 1, 1), ahead);
    settings.shading = Shading::flat;
    const Picture flat = WallRenders(dataset, settings).draw(wallOf(200, 200, 1, 1), ahead);

    // In the middle the true sphere's shade is known: facing is the cosine between the normal and the view.
    double smoothError = 0, flatError = 0;
    for (int x = 60; x < 140; ++x) {
        const double tangent = (x + 0.5 - 100) / 100 * std::tan(10 * 3.14159265358979 / 180);
        const double sine = 5 * tangent / std::sqrt(1 + tangent * tangent);  // of the angle at the surface
        const double expected = 255 * 0.8 * (0.25 + 0.75 * std::sqrt(1 - sine * sine));
        smoothError = std::max(smoothError, std::abs(picture.color.at(x, 100)[0] - expected));
        flatError = std::max(flatError, std::abs(flat.color.at(x, 100)[0] - expected));
    }
    EXPECT_LT(smoothError, 4);
    EXPECT_GT(flatError, 8);
}

}  // namespace
}  // namespace iwalk
