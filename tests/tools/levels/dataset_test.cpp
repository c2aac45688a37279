#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "tests/common/temp_directory.hpp"
#include "tests/tools/levels/cracks.hpp"
#include "tests/tools/levels/errors.hpp"
#include "tests/tools/levels/level_triangles.hpp"
#include "tests/tools/levels/report.hpp"
#include "tests/tools/levels/simplify_race.hpp"
#include "tests/tools/levels/tube_dataset.hpp"

namespace iwalk::levels {
namespace {

constexpr double kStepUnits = 0.5;            // of the tube's lattice
constexpr std::int32_t kStepParts = 1 << 17;  // 2^29 parts for 2^12 steps

// The tube's triangles at a level that are not degenerate there.
std::size_t tubeCount(int level) {
    std::size_t count = 0;
    for (int segment = 0; segment < kSegments; ++segment) {
        for (const TubeTriangle& triangle : tubeTriangles(segment)) count += isGone(triangle, level) ? 0 : 1;
    }
    return count;
}

std::vector<double> errorsOf(const DatasetPages& pages) {
    std::vector<double> errors;
    for (const LevelSummary& level : pages.manifest().levels) errors.push_back(level.error / kStepUnits);
    return errors;
}

class LevelsOfADataset : public testing::Test {
  protected:
    LevelsOfADataset() {
        writeTube(directory_.path(""));
        auto pages = DatasetPages::open(directory_.path(""));
        EXPECT_TRUE(pages.ok()) << (pages.ok() ? "" : pages.error().message);
        pages_ = std::make_unique<DatasetPages>(std::move(*pages));
    }

    // x of all corners, in lattice steps from the root's cell.
    static std::set<double> ringsOf(const std::vector<FixedTriangle>& triangles) {
        std::set<double> rings;
        for (const FixedTriangle& triangle : triangles) {
            for (const Corner& corner : triangle) rings.insert(static_cast<double>(corner.x) / kStepParts);
        }
        return rings;
    }

    TempDirectory directory_;
    std::unique_ptr<DatasetPages> pages_;
};

TEST_F(LevelsOfADataset, WholeModelsAreThoseOfEachLevel) {
    const FixedGrid grid(pages_->hierarchy());
    EXPECT_EQ(grid.unit(pages_->manifest()), kStepUnits / kStepParts);
    for (const auto& [level, at] : {std::pair(0u, 0), std::pair(1u, 1), std::pair(2u, kInput),
                                    std::pair(unsigned{kFullLevel}, kInput)}) {
        const auto triangles = levelTriangles(*pages_, grid, level);
        ASSERT_TRUE(triangles.ok());
        EXPECT_EQ(triangles->size(), tubeCount(at));
        std::set<double> rings;
        for (int ring = 0; ring <= kSegments; ++ring)
            rings.insert(static_cast<double>(tubePoint({ring, 0}, at).x));
        EXPECT_EQ(ringsOf(*triangles), rings);
    }
}

TEST_F(LevelsOfADataset, HalfMorphsLieInTheMiddle) {
    const FixedGrid grid(pages_->hierarchy());
    for (const int level : {0, 1}) {
        const auto triangles = halfMorphTriangles(*pages_, grid, static_cast<unsigned>(level));
        ASSERT_TRUE(triangles.ok());
        std::set<double> rings;
        for (int ring = 0; ring <= kSegments; ++ring) {
            const auto fine = tubePoint({ring, 0}, level + 1).x, coarse = tubePoint({ring, 0}, level).x;
            rings.insert(static_cast<double>(fine + coarse) / 2);
        }
        EXPECT_EQ(ringsOf(*triangles), rings);
    }
}

TEST_F(LevelsOfADataset, ErrorsAreWithinWhatTheTubeMoves) {
    const auto levels = measureErrors(*pages_, {20'000, 1});
    ASSERT_TRUE(levels.ok());
    ASSERT_EQ(levels->size(), 2u);
    for (const LevelErrors& level : *levels) {
        const double steps = level.error / kStepUnits;
        // Rings are up to two steps out of line, and the tube's end moves by two rings or less.
        EXPECT_GT(level.whole.fromFull.p99, 0.2 / steps);
        EXPECT_LT(level.whole.fromFull.p99, 2.0 / steps);
        EXPECT_LE(level.whole.largest(), 2.01 * kTubeStep / steps);
        EXPECT_LT(level.halfMorph.fromFull.p99, level.whole.fromFull.p99);
    }
    EXPECT_GT(largestRatio(*levels), 0);
    const auto json = nlohmann::json::parse(errorsJson(*levels, 1));
    EXPECT_EQ(json["levels"][1]["triangles"], tubeCount(1));
}

TEST_F(LevelsOfADataset, CutsHaveNoCracks) {
    const auto model = loadRangeModel(*pages_);
    ASSERT_TRUE(model.ok());
    EXPECT_EQ(model->vanished, 0u);
    EXPECT_EQ(model->ranges().size(), 4u + 8 + 16);
    CrackOptions options;
    options.pairs = 300, options.minScreenError = 2, options.maxScreenError = 200;
    const CrackReport report = countCracks(*model, errorsOf(*pages_), options);
    EXPECT_EQ(report.full.openEdges, 0u);
    EXPECT_EQ(report.full.triangles, tubeCount(kInput));
    EXPECT_EQ(report.openEdges, 0u);
    EXPECT_EQ(report.looseBoxes, 0u);
    EXPECT_GT(report.twoLevels, 20u);
    EXPECT_GT(report.moreLevels, 0u);
    const auto json = nlohmann::json::parse(cracksJson(report, options));
    EXPECT_EQ(json["open_edges"], 0);
}

TEST_F(LevelsOfADataset, RaceFindsMeshesThatAreAsGood) {
    const auto levels = raceSimplify(*pages_, {5'000, 1});
    ASSERT_TRUE(levels.ok());
    ASSERT_EQ(levels->size(), 2u);
    const SimplifyRace &coarse = levels->at(0), &fine = levels->at(1);
    EXPECT_GT(coarse.theirTriangles, 0u);
    EXPECT_LE(coarse.theirTriangles, fine.theirTriangles);
    EXPECT_LE(fine.theirTriangles, tubeCount(kInput));
    EXPECT_EQ(nlohmann::json::parse(simplifyJson(*levels))["levels"].size(), 2u);
}

TEST_F(LevelsOfADataset, DamagedPagesAreNamed) {
    std::string bytes(pages_->manifest().pageFiles[0].bytes, 'x');
    directory_.write("pages-1.bin", bytes);
    const auto model = loadRangeModel(*pages_);
    ASSERT_FALSE(model.ok());
    EXPECT_NE(model.error().message.find("pages-1.bin: page 0"), std::string::npos);
}

}  // namespace
}  // namespace iwalk::levels
