#include "tests/tools/levels/cracks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/tools/levels/open_edges.hpp"
#include "tests/tools/levels/tube.hpp"
#include "tests/tools/levels/views.hpp"

namespace iwalk::levels {
namespace {

TEST(OpenEdges, OfClosedAndOpenSurfaces) {
    const std::vector<std::uint32_t> tetrahedron{0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
    EXPECT_EQ(openEdges({}), 0u);
    EXPECT_EQ(openEdges(tetrahedron), 0u);
    std::vector<std::uint32_t> open(tetrahedron.begin(), tetrahedron.end() - 3);
    EXPECT_EQ(openEdges(open), 3u);
    for (const std::uint32_t corner : {2u, 0u, 3u}) open.push_back(corner);  // the wrong way round
    EXPECT_EQ(openEdges(open), 3u);
    std::vector<std::uint32_t> lines(tetrahedron);
    for (const std::uint32_t corner : {0u, 1u, 1u, 5u, 5u, 5u}) lines.push_back(corner);
    EXPECT_EQ(openEdges(lines), 0u);
    EXPECT_EQ(openEdges(std::vector<std::uint32_t>{7, 8, 9, 9, 8, 7}), 0u);
}

TEST(LevelDistances, FollowErrorsDiagonalsAndDoubling) {
    // 900 e / (t 0.7)
    EXPECT_NEAR(levelDistances({8}, {0}, 900, 2)[0], 900 * 8 / 1.4, 1e-9);
    EXPECT_NEAR(levelDistances({8}, {36000}, 900, 2)[0], 100000, 1e-9);
    const std::vector<double> distances = levelDistances({4, 2, 1}, {0, 0, 3600}, 0.7, 1);
    EXPECT_NEAR(distances[2], 10000, 1e-9);
    EXPECT_NEAR(distances[1], 20000, 1e-9);
    EXPECT_NEAR(distances[0], 40000, 1e-9);
}

// Cells are this many segments long, the same at all levels.
constexpr int kPerCell = 8, kCells = kSegments / kPerCell + 1;

int firstSegment(int cell) {
    return std::clamp(cell * kPerCell - kFirstStep, 0, kSegments);
}

void addTriangles(RangeModel& model, CutRange& range, int segment) {
    for (const TubeTriangle& triangle : tubeTriangles(segment)) {
        if (isGone(triangle, range.level)) continue;
        for (const RingCorner& corner : triangle) {
            const LatticePoint p = tubePoint(corner, range.level);
            range.box.add(p);
            range.corners.push_back(
                model.vertex(p, range.next < 0 ? p : tubePoint(corner, range.next), range.next));
        }
    }
}

// Ranges kTubeLevels + 1 a cell, from coarse to fine.
RangeModel makeTube() {
    RangeModel model(kTubeLevels);
    for (int cell = 0; cell < kCells; ++cell) {
        LatticeBox box;
        const std::size_t first = model.ranges().size();
        for (int level = 0; level <= kInput; ++level) {
            CutRange range{{}, level, level - 1, kNoRange, {}};
            for (int segment = firstSegment(cell); segment < firstSegment(cell + 1); ++segment)
                addTriangles(model, range, segment);
            if (level > 0) range.parent = static_cast<std::uint32_t>(model.ranges().size()) - 1;
            box.add(range.box);
            model.add(std::move(range));
        }
        // Coarse boxes contain finer ones.
        for (std::size_t i = first; i < model.ranges().size(); ++i) model.ranges()[i].box = box;
    }
    return model;
}

const std::vector<double> kErrors{32, 16};
constexpr CrackOptions kOptions{300, 1, Diagonals::kLevels, 900, 5, 200};

TEST(Cracks, ATubeInThreeResolutionsHasNone) {
    const CrackReport report = countCracks(makeTube(), kErrors, kOptions);
    EXPECT_EQ(report.full.openEdges, 0u);
    EXPECT_EQ(report.full.triangles, 8u * kSegments + 4);
    EXPECT_EQ(report.openEdges, 0u);
    EXPECT_EQ(report.looseBoxes, 0u);
    EXPECT_GT(report.twoLevels, 20u);
    EXPECT_GT(report.moreLevels, 20u);
    EXPECT_LT(report.leastTriangles, report.mostTriangles);
}

// The tube without its ends and some triangles in between.
TEST(Cracks, AnOpenInputHasNoneBesidesItsBorder) {
    RangeModel model = makeTube();
    for (CutRange& range : model.ranges()) {
        std::vector<MorphVertex> kept;
        for (std::size_t i = 0; i < range.corners.size(); i += 3) {
            bool end = true, hole = true;
            for (std::size_t c = i; c < i + 3; ++c) {
                const auto x = static_cast<std::int64_t>(model.places()[range.corners[c].place].x);
                end = end && (x == ringX(0) || x == ringX(kSegments));
                hole = hole && x >= ringX(64) && x <= ringX(68);
            }
            if (!end && !hole)
                kept.insert(kept.end(), range.corners.begin() + static_cast<std::ptrdiff_t>(i),
                            range.corners.begin() + static_cast<std::ptrdiff_t>(i) + 3);
        }
        range.corners = std::move(kept);
    }
    const CrackReport report = countCracks(model, kErrors, kOptions);
    EXPECT_EQ(report.full.openEdges, 16u);
    EXPECT_EQ(report.openEdges, 0u);
    EXPECT_GT(report.moreLevels, 20u);
    model.ranges()[3 * 10].corners.clear();
    EXPECT_GT(countCracks(model, kErrors, kOptions).openEdges, 0u);
}

TEST(Cracks, AWrongTargetIsFound) {
    RangeModel model = makeTube();
    CutRange& range = model.ranges()[3 * 10 + 2];  // the input's, in a middle cell
    MorphVertex& vertex = range.corners.front();
    vertex.target = model.vertex({1, 2, 3}, {1, 2, 3}, 1).place;
    EXPECT_GT(countCracks(model, kErrors, kOptions).openEdges, 0u);
}

TEST(Cracks, MorphsThatOverlapAreFound) {
    // Level 0 begins where level 1 does: one side of a border morphs to level 1, the other on to level 0.
    const RangeModel model = makeTube();
    CutDrawer drawer(model);
    std::uint64_t open = 0;
    for (int i = 0; i < 100; ++i) open += drawer.draw({i * kTubeStep, 5, 300}, {1010, 1000}).openEdges;
    EXPECT_GT(open, 0u);
}

TEST(Cracks, AMissingRangeIsFound) {
    RangeModel model = makeTube();
    model.ranges()[3 * 10].corners.clear();
    CutDrawer drawer(model);
    EXPECT_EQ(drawer.draw({0, 0, 1e7}, {1000, 500}).openEdges, 8u);
    EXPECT_EQ(drawer.drawFull().openEdges, 0u);
}

TEST(Cracks, BoxesThatAreTooSmallAreCounted) {
    RangeModel model = makeTube();
    model.ranges()[0].box.max.y -= 1;
    EXPECT_EQ(countCracks(model, kErrors, {1, 1, Diagonals::kLevels, 900, 5, 200}).looseBoxes, 1u);
}

TEST(RangeModel, DiagonalsCountTheInputForAllFinerLevels) {
    RangeModel model(4);
    model.add({{LatticePoint(0), LatticePoint(30, 40, 0)}, 0, -1, kNoRange, {}});
    model.add({{LatticePoint(0), LatticePoint(3, 4, 0)}, 1, 0, 0, {}});
    model.add({{LatticePoint(0), LatticePoint(6, 8, 0)}, model.fullLevel(), 1, 1, {}});
    EXPECT_EQ(model.diagonals(false), (std::vector<double>{50, 5, 0, 0}));
    EXPECT_EQ(model.diagonals(true), (std::vector<double>{50, 5, 10, 10}));
}

TEST(Views, ATubeInThreeResolutionsLetsNothingThrough) {
    const ViewOptions options{20, 1, 64, 2, 20};
    const ViewReport report = countHoles(makeTube(), kErrors, options);
    EXPECT_EQ(report.holes, 0u);
    EXPECT_GT(report.covered, 1000u);
    RangeModel open = makeTube();
    for (std::size_t i = 1; i < open.ranges().size(); i += 3) open.ranges()[i].corners.clear();  // level 1
    for (std::size_t i = 0; i < open.ranges().size(); i += 3) open.ranges()[i].corners.clear();  // level 0
    EXPECT_GT(countHoles(open, kErrors, options).holes, 0u);
}

}  // namespace
}  // namespace iwalk::levels
