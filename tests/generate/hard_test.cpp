// The scenes that break what is careless: they have what they promise, and build like others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "preprocess/build/verify.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/generate/generated.hpp"

namespace iwalk {
namespace {

struct Scene {
    std::vector<Triangle> triangles;
    Generated made;
    ImportSummary summary;
    TempDirectory directory;

    explicit Scene(const std::string& name, std::uint64_t count = 20'000) {
        made = generate(name, count, directory.path("a.ply"));
        const auto importer =
            openImporter(directory.path("a.ply"), {std::uint64_t{64} << 20, directory.path("")});
        summary = (*importer)->scan([](std::span<const glm::dvec3>) {}, {}).value();
        EXPECT_TRUE((*importer)
                        ->triangles(
                            [&](std::span<const Triangle> batch) {
                                triangles.insert(triangles.end(), batch.begin(), batch.end());
                                return Result<void>();
                            },
                            {})
                        .ok());
    }
};

// The longest side, and twice the area over it.
struct Shape {
    double length, width;
};
Shape shapeOf(const Triangle& t) {
    const glm::dvec3 a = t[1].position - t[0].position, b = t[2].position - t[1].position, c = a + b;
    const double length = std::max({glm::length(a), glm::length(b), glm::length(c)});
    return {length, glm::length(glm::cross(a, c)) / length};
}

class HardTest : public testing::TestWithParam<const char*> {};

TEST_P(HardTest, BuildsAndVerifies) {
    const Scene scene(GetParam());
    EXPECT_NEAR(static_cast<double>(scene.made.triangles), 20'000, 200);
    QuietProgress progress;
    BuildOptions options;
    options.inputs = {scene.directory.path("a.ply")};
    options.output = scene.directory.path("dataset");
    const auto manifest = buildDataset(options, progress);
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    const Provenance& input = manifest->provenance.at(0);
    const std::string name = GetParam();
    if (name == "hard-outlier") {
        EXPECT_EQ(input.split, 1u);
        EXPECT_EQ(input.cut, 1u);
        EXPECT_EQ(input.droppedDegenerate, 0u);
        EXPECT_EQ(manifest->stepExponent, 4 - 24);  // as of 10 units
        // One is in some pieces.
        EXPECT_GT(manifest->triangles, scene.made.triangles);
        EXPECT_LT(manifest->triangles, scene.made.triangles + 100);
    } else {
        EXPECT_EQ(input.split + input.cut, 0u);
        EXPECT_EQ(manifest->triangles + input.droppedDegenerate, scene.made.triangles);
    }
    if (name != "hard-slivers") {
        EXPECT_LE(input.droppedDegenerate, 200u);
    }
    const auto verified = verifyDataset(options.output, progress);
    ASSERT_TRUE(verified.ok()) << verified.error().message;
    EXPECT_TRUE(verified->problems.empty()) << verified->problems.front();
}

INSTANTIATE_TEST_SUITE_P(Scenes, HardTest,
                         testing::Values("hard-far", "hard-slivers", "hard-point", "hard-flat",
                                         "hard-outlier", "hard-huge"),
                         [](const auto& scene) { return std::string(scene.param).substr(5); });

TEST(HardSceneTest, farIsFarWithMillimetres) {
    const Scene scene("hard-far");
    EXPECT_GT(scene.summary.bounds.min.x, 9e6);
    EXPECT_GT(scene.summary.bounds.min.z, 9e6);
    EXPECT_LT(scene.summary.precision, 1e-6);
    for (const Triangle& t : scene.triangles) {
        EXPECT_GT(shapeOf(t).width, 1e-4);
        EXPECT_LT(shapeOf(t).length, 0.01);
    }
}

TEST(HardSceneTest, slivers) {
    const Scene scene("hard-slivers");
    std::size_t thin = 0, flat = 0;
    for (const Triangle& t : scene.triangles) {
        const auto [length, width] = shapeOf(t);
        flat += width < 1e-12 * length;
        thin += width > 1e-7 * length && width < 1e-5 * length;
    }
    EXPECT_GT(flat, 3'900u);
    EXPECT_GT(thin, 7'900u);
}

TEST(HardSceneTest, pointIsInAllTriangles) {
    const Scene scene("hard-point");
    EXPECT_TRUE(std::ranges::all_of(scene.triangles,
                                    [](const Triangle& t) { return t[0].position == glm::dvec3(0); }));
}

TEST(HardSceneTest, flatIsFlat) {
    const Scene scene("hard-flat");
    EXPECT_EQ(scene.summary.bounds.min.z, scene.summary.bounds.max.z);
    EXPECT_TRUE(std::ranges::all_of(scene.triangles, [](const Triangle& t) {
        return glm::cross(t[1].position - t[0].position, t[2].position - t[0].position).z > 0;
    }));
}

TEST(HardSceneTest, oneTriangleStandsOut) {
    const auto longest = [](const Scene& scene) {
        std::vector<double> lengths;
        for (const Triangle& t : scene.triangles) lengths.push_back(shapeOf(t).length);
        std::ranges::sort(lengths, std::greater());
        return std::pair(lengths[0], lengths[1]);
    };
    const auto [outlier, others] = longest(Scene("hard-outlier"));
    EXPECT_GT(outlier, 1e7);
    EXPECT_LT(others, 1);
    const auto [huge, small] = longest(Scene("hard-huge"));
    EXPECT_GT(huge, 10);
    EXPECT_LT(small, 1);
}

}  // namespace
}  // namespace iwalk
