// The scenes that break what is careless: generated, built, verified, and drawn as the ray caster sees the
// generated file.
#include <gtest/gtest.h>

#include "preprocess/build/verify.hpp"
#include "preprocess/generate/generate.hpp"
#include "preprocess/import/importer.hpp"
#include "tests/server/render_fixture.hpp"
#include "tests/server/wall_renders.hpp"
#include "tests/tools/depth_agreement.hpp"
#include "tests/tools/ray_caster.hpp"

namespace iwalk {
namespace {

using namespace tools;

constexpr int kWidth = 320, kHeight = 240;

struct HardScene {
    const char* name;
    Camera camera;
    // Of all pixels, at least so many have the ray caster's depth. Of a part of the slivers' pixels a
    // triangle is the nearest that is thinner than the lattice's step.
    double agreement = 0.999;
    double outlines = 0.01;  // of all pixels, those that only one of full and the next coarser level covers
};

void PrintTo(const HardScene& scene, std::ostream* out) {
    *out << scene.name;
}

class HardSceneTest : public RenderTest, public testing::WithParamInterface<HardScene> {
  protected:
    Triangles generated(const std::string& path) {
        Silent silent;
        const auto made = generateScene({GetParam().name, 20'000, 1, path}, silent);
        EXPECT_TRUE(made.ok()) << made.error().message;
        Triangles triangles;
        auto importer = openImporter(path, {std::uint64_t{64} << 20, directory_.path("")});
        EXPECT_TRUE(importer.ok() && (*importer)->scan([](auto) {}, [](double) {}).ok());
        const TriangleSink sink = [&](std::span<const iwalk::Triangle> batch) {
            for (const iwalk::Triangle& t : batch)
                triangles.push_back({t[0].position, t[1].position, t[2].position});
            return Result<void>();
        };
        EXPECT_TRUE((*importer)->triangles(sink, [](double) {}).ok());
        return triangles;
    }
};

TEST_P(HardSceneTest, IsDrawnAsItIs) {
    const std::string ply = directory_.path("scene.ply");
    const RayCaster caster(generated(ply));
    const Dataset dataset = buildFile(ply);
    Silent silent;
    const auto verified = verifyDataset(directory_.path("dataset"), silent);
    ASSERT_TRUE(verified.ok()) << verified.error().message;
    EXPECT_EQ(verified->problems, std::vector<std::string>{});

    Settings settings;
    settings.near = 1e-4;
    const Camera& camera = GetParam().camera;
    const CastPicture cast = castPicture(caster, camera, kWidth, kHeight, settings.near);
    const auto draw = [&] {
        return WallRenders(dataset, settings).draw(wallOf(kWidth, kHeight, 1, 1), camera);
    };
    const Picture full = draw();
    const DepthAgreement agreement = depthAgreement(full.depth, cast.depth, 1e-4);
    EXPECT_GE(agreement.fraction(), GetParam().agreement);
    settings.mode = Mode::frustum;
    EXPECT_EQ(compare(full, draw(), std::nullopt).different, 0u);

    // The next coarser level covers the same pixels, but for outlines.
    settings.level = static_cast<std::uint8_t>(dataset.manifest.levels.size() - 1);
    const DepthAgreement coarse = depthAgreement(draw().depth, cast.depth, 1e-4);
    EXPECT_LT(static_cast<double>(coarse.missing + coarse.extra),
              GetParam().outlines * static_cast<double>(coarse.pixels));
}

const Camera kAbove{{5, -6, 6}, {5, 5, 0}, {0, 0, 1}, 50};
// At millimetres, far from the origin.
const Camera kFar{{1e7 + 0.05, 1e7 - 0.06, 1e7 + 0.07}, {1e7 + 0.05, 1e7 + 0.05, 1e7}, {0, 0, 1}, 50};
const Camera kPoint{{-12, -14, 9}, {0, 0, 0}, {0, 0, 1}, 50};

INSTANTIATE_TEST_SUITE_P(Scenes, HardSceneTest,
                         testing::Values(HardScene{"hard-far", kFar},
                                         HardScene{"hard-slivers", kAbove, 0.97, 0.05},
                                         HardScene{"hard-point", kPoint}, HardScene{"hard-flat", kAbove},
                                         HardScene{"hard-outlier", kAbove}, HardScene{"hard-huge", kAbove}),
                         [](const auto& scene) { return std::string(scene.param.name).substr(5); });

}  // namespace
}  // namespace iwalk
