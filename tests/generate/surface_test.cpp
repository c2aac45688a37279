// What the scenes' surfaces are like: closed, of the right number, readable.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "preprocess/build/build.hpp"
#include "preprocess/generate/isosurface_grid.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/generate/generated.hpp"

namespace iwalk {
namespace {

class SurfaceTest : public testing::TestWithParam<const char*> {
  protected:
    Model model(std::uint64_t triangles, std::uint64_t seed = 1) const {
        generate(GetParam(), triangles, directory_.path("a.ply"), seed);
        return readModel(directory_.path("a.ply"));
    }
    TempDirectory directory_;
};

TEST_P(SurfaceTest, CountIsWithinAPercent) {
    for (const std::uint64_t wanted : {1'000, 1'777, 4'000, 12'345, 50'000, 200'000, 1'300'000}) {
        for (const std::uint64_t seed : {1, 2}) {
            const Generated made = generate(GetParam(), wanted, directory_.path("a.ply"), seed);
            EXPECT_NEAR(static_cast<double>(made.triangles), static_cast<double>(wanted),
                        static_cast<double>(wanted) * 0.01)
                << "seed " << seed;
        }
    }
}

TEST_P(SurfaceTest, HasNoDegenerateTrianglesAndNoStrayVertices) {
    const Model made = model(30'000);
    std::vector<bool> used(made.positions.size());
    for (const auto& [a, b, c] : made.triangles) {
        EXPECT_NE(made.positions[a], made.positions[b]);
        EXPECT_NE(made.positions[b], made.positions[c]);
        EXPECT_NE(made.positions[c], made.positions[a]);
        used[a] = used[b] = used[c] = true;
    }
    EXPECT_EQ(std::ranges::count(used, false), 0);
}

TEST_P(SurfaceTest, MakesADataset) {
    generate(GetParam(), 50'000, directory_.path("a.ply"));
    QuietProgress progress;
    BuildOptions options;
    options.inputs = {directory_.path("a.ply")};
    options.output = directory_.path("dataset");
    const auto manifest = buildDataset(options, progress);
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    EXPECT_NEAR(static_cast<double>(manifest->triangles), 50'000, 500);
    EXPECT_EQ(manifest->provenance.at(0).droppedDegenerate, 0u);
    EXPECT_EQ(manifest->colors, std::string(GetParam()) != "sphere");
}

INSTANTIATE_TEST_SUITE_P(Scenes, SurfaceTest, testing::Values("sphere", "plant", "isosurface", "terrain"),
                         [](const auto& scene) { return std::string(scene.param); });

TEST(SphereTest, IsClosed) {
    const TempDirectory directory;
    for (const std::uint64_t triangles : {1'000, 20'000}) {
        generate("sphere", triangles, directory.path("a.ply"));
        const Model model = readModel(directory.path("a.ply"));
        const OpenEdges open = openEdges(model);
        EXPECT_EQ(open.once.size(), 0u);
        EXPECT_EQ(open.bad, 0u);
        EXPECT_EQ(model.triangles.size(), 2 * model.positions.size() - 4);  // Euler: one sphere
        double volume = 0;                                                  // six times
        for (const auto& [a, b, c] : model.triangles) {
            const glm::dvec3 p(model.positions[a]), q(model.positions[b]), r(model.positions[c]);
            volume += glm::dot(p, glm::cross(q, r));
        }
        EXPECT_GT(volume / 6, 3000);  // outside is outside
    }
}

TEST(PlantTest, PartsAreClosed) {
    const TempDirectory directory;
    generate("plant", 300'000, directory.path("a.ply"));
    const OpenEdges open = openEdges(readModel(directory.path("a.ply")));
    EXPECT_EQ(open.once.size(), 0u);
    EXPECT_EQ(open.bad, 0u);
}

TEST(IsosurfaceTest, IsOpenAtTheSidesAlone) {
    const TempDirectory directory;
    for (const std::uint64_t seed : {1, 2, 3}) {
        generate("isosurface", 100'000, directory.path("a.ply"), seed);
        const Model model = readModel(directory.path("a.ply"));
        const OpenEdges open = openEdges(model);
        EXPECT_EQ(open.bad, 0u);
        EXPECT_GT(open.once.size(), 0u);
        const auto side = static_cast<float>(kLayerSide);
        for (const auto& edge : open.once) {
            const glm::vec3 a = model.positions[edge[0]], b = model.positions[edge[1]];
            EXPECT_TRUE((a.x == 0 && b.x == 0) || (a.x == side && b.x == side) || (a.y == 0 && b.y == 0) ||
                        (a.y == side && b.y == side));
        }
    }
}

TEST(IsosurfaceTest, HasOverhangs) {
    const TempDirectory directory;
    generate("isosurface", 100'000, directory.path("a.ply"));
    const Model model = readModel(directory.path("a.ply"));
    std::size_t down = 0;
    for (const auto& [a, b, c] : model.triangles) {
        const glm::vec3 p = model.positions[a];
        down += glm::cross(model.positions[b] - p, model.positions[c] - p).z < 0 ? 1u : 0u;
    }
    EXPECT_GT(down, model.triangles.size() / 10);
    EXPECT_LT(down, model.triangles.size() / 2);
}

}  // namespace
}  // namespace iwalk
