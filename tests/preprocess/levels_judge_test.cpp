// Levels as built, judged by other means than they were made: open edges in cuts, and sampled distances.
#include <gtest/gtest.h>

#include "preprocess/build/verify.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/levels_models.hpp"
#include "tests/tools/levels/cracks.hpp"
#include "tests/tools/levels/report.hpp"

namespace iwalk {
namespace {

using levels::DatasetPages;

class LevelJudgeTest : public testing::Test {
  protected:
    DatasetPages build(const FakeInput& input, std::uint32_t leafTriangles, const BuildParts& parts = {}) {
        const auto manifest = buildFrom(input, directory_.path("d"), {.leafTriangles = leafTriangles}, parts);
        EXPECT_TRUE(manifest.ok()) << manifest.error().message;
        auto pages = DatasetPages::open(directory_.path("d"));
        EXPECT_TRUE(pages.ok()) << pages.error().message;
        return std::move(*pages);
    }

    static levels::CrackReport cracks(const DatasetPages& pages) {
        const auto model = levels::loadRangeModel(pages);
        EXPECT_TRUE(model.ok()) << model.error().message;
        std::vector<double> errors;  // steps
        for (unsigned level = 0; level < pages.manifest().levels.size(); ++level) {
            errors.push_back(levelErrorSteps(pages.hierarchy().rootCellLog2, level));
        }
        return levels::countCracks(*model, errors, {.pairs = 50});
    }

    // The largest distance between a level and the input, as a part of what is stated.
    static double worst(const DatasetPages& pages, unsigned samples = 4000) {
        const auto measured = levels::measureErrors(pages, {.samples = samples, .seed = 1});
        EXPECT_TRUE(measured.ok()) << measured.error().message;
        EXPECT_EQ(measured->size(), pages.manifest().levels.size());
        return levels::largestRatio(*measured);
    }

    TempDirectory directory_;
};

TEST_F(LevelJudgeTest, AClosedSphereStaysClosed) {
    const levels::CrackReport report = cracks(build(noisySphere(70), 1000));
    EXPECT_EQ(report.full.triangles, 12u * 70 * 70);
    EXPECT_EQ(report.full.openEdges, 0u);
    EXPECT_EQ(report.openEdges, 0u);
    EXPECT_EQ(report.looseBoxes, 0u);
    EXPECT_GT(report.twoLevels + report.moreLevels, 5u);
    EXPECT_LT(report.leastTriangles, report.full.triangles / 8);
}

TEST_F(LevelJudgeTest, BoxesOfRangesNest) {
    EXPECT_EQ(cracks(build(plant(20'000), 1000)).looseBoxes, 0u);
    EXPECT_EQ(cracks(build(makeSoup(20'000, 1e-3, 0.3, 4, true), 1000)).looseBoxes, 0u);
}

TEST_F(LevelJudgeTest, ASphereIsAsFarAsStated) {
    const DatasetPages pages = build(noisySphere(70), 1000);
    ASSERT_GE(pages.manifest().levels.size(), 3u);
    EXPECT_LE(worst(pages), 1.0);
}

TEST_F(LevelJudgeTest, APlantIsAsFarAsStated) {
    EXPECT_LE(worst(build(plant(20'000), 1000)), 1.0);
}

TEST_F(LevelJudgeTest, ASoupIsAsFarAsStated) {
    EXPECT_LE(worst(build(makeSoup(20'000, 1e-3, 0.3, 4, true), 1000)), 1.0);
}

// More triangles around a vertex than a cell looks at.
TEST_F(LevelJudgeTest, ACrowdAroundAVertexIsAsFarAsStated) {
    const DatasetPages pages = build(fan(100'000), 1000);
    ASSERT_GE(pages.manifest().levels.size(), 2u);
    EXPECT_LE(worst(pages, 200), 1.0);
    NoProgress progress;
    EXPECT_EQ(verifyDataset(directory_.path("d"), progress).value().problems, std::vector<std::string>{});
}

// Cells that have too many triangles even for their halves.
TEST_F(LevelJudgeTest, WhatIsDecidedInHalvesFits) {
    BuildParts parts;
    parts.levels.cellTriangles = 2000;
    const DatasetPages pages = build(noisySphere(70), 1000, parts);
    const levels::CrackReport report = cracks(pages);
    EXPECT_EQ(report.full.openEdges + report.openEdges + report.looseBoxes, 0u);
    EXPECT_LT(report.leastTriangles, report.full.triangles / 4);
    EXPECT_LE(worst(pages), 1.0);
    NoProgress progress;
    EXPECT_EQ(verifyDataset(directory_.path("d"), progress).value().problems, std::vector<std::string>{});
}

// Two spheres that touch nowhere, one of them far below every level's error: it goes on as something.
TEST_F(LevelJudgeTest, SmallPartsStay) {
    FakeInput input = noisySphere(20);
    for (Triangle triangle : noisySphere(4).triangles) {
        for (Corner& corner : triangle) corner.position = 1e-3 * corner.position + glm::dvec3(0, 0, 2);
        input.triangles.push_back(triangle);
    }
    EXPECT_LE(worst(build(input, 200)), 1.0);
}

// Two plates with windows that lie upon one another: borders of the windows have two triangles each, and are
// borders.
TEST_F(LevelJudgeTest, BordersOfSheetsUponOneAnotherStay) {
    constexpr int kEdge = 64;
    FakeInput input;
    const auto corner = [](int x, int y) { return Corner{glm::dvec3(x, y, 0)}; };
    for (int y = 0; y < kEdge; ++y) {
        for (int x = 0; x < kEdge; ++x) {
            if (x % 8 >= 3 && x % 8 < 6 && y % 16 >= 2 && y % 16 < 13) continue;
            const Corner a = corner(x, y), b = corner(x + 1, y), c = corner(x + 1, y + 1),
                         d = corner(x, y + 1);
            for (int sheet = 0; sheet < 2; ++sheet) {
                input.triangles.push_back({a, b, c});
                input.triangles.push_back({a, c, d});
            }
        }
    }
    EXPECT_LE(worst(build(input, 1000)), 1.1);  // 1.06; 7.7 when they are not known as borders
}

}  // namespace
}  // namespace iwalk
