#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "server/visibility/frustum_visibility.hpp"
#include "server/visibility/plp_spending.hpp"
#include "server/visibility/plp_visibility.hpp"
#include "server/visibility/ray_grid.hpp"
#include "tests/common/dataset_fixture.hpp"
#include "tests/server/sight_fixture.hpp"

namespace iwalk {
namespace {

constexpr std::int64_t kLeafEdge = 64;  // steps
constexpr std::uint32_t kRangeTriangles = 100, kRanges = 4;

// 4 x 4 x 4 leaves of kLeafEdge steps, opaque or not, each with a page of kRanges ranges, slabs along z.
struct Grid {
    Hierarchy hierarchy;
    std::vector<PageTable> tables;
    std::vector<LatticePoint> cells;
    Cut cut;
    mutable Workers workers{2};

    explicit Grid(std::uint8_t opacity = 0) {
        hierarchy.rootCellLog2 = 8;
        addNode(LatticePoint(0), 0);
        for (std::uint32_t octant = 0; octant < 8; ++octant) addNode(placeOf(octant) * (2 * kLeafEdge), 1);
        addChildren(0, 1);
        for (std::uint32_t parent = 1; parent <= 8; ++parent) {
            addChildren(parent, static_cast<std::uint32_t>(hierarchy.nodes.size()));
            for (std::uint32_t octant = 0; octant < 8; ++octant)
                addLeaf(placeOf(parent - 1) * (2 * kLeafEdge) + placeOf(octant) * kLeafEdge, opacity);
        }
        update();
    }

    static LatticePoint placeOf(std::uint32_t octant) {
        return LatticePoint(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
    }
    void update() {
        cells = cellsOfNodes(hierarchy);
        cut = cutAtLevel(hierarchy, kFullLevel);
    }

    NodeRecord& addNode(const LatticePoint& corner, unsigned depth) {
        NodeRecord node{};
        for (int axis = 0; axis < 3; ++axis) {
            node.boxMin[axis] = corner[static_cast<glm::length_t>(axis)];
            node.boxMax[axis] = node.boxMin[axis] + (std::int64_t{4 * kLeafEdge} >> depth);
            node.ownMin[axis] = std::numeric_limits<std::int64_t>::max();
            node.ownMax[axis] = std::numeric_limits<std::int64_t>::lowest();
        }
        node.depth = static_cast<std::uint8_t>(depth);
        node.firstEntry = static_cast<std::uint32_t>(hierarchy.entries.size());
        return hierarchy.nodes.emplace_back(node);
    }
    void addChildren(std::uint32_t node, std::uint32_t first) {
        hierarchy.nodes[node].firstChild = first;
        hierarchy.nodes[node].childMask = 255;
    }
    void addLeaf(const LatticePoint& corner, std::uint8_t opacity) {
        NodeRecord& leaf = addNode(corner, 2);
        std::ranges::fill(leaf.opacity, opacity);
        const auto low = Hierarchy::box(leaf);
        giveTriangles(leaf, low, kRanges);
    }
    // A page of its own, with ranges that are slabs of `box`.
    void giveTriangles(NodeRecord& node, const LatticeBox& box, std::uint32_t ranges) {
        LevelRecord entry{};
        entry.firstPage = static_cast<std::uint32_t>(hierarchy.pages.size()), entry.pageCount = 1;
        entry.rangeCount = static_cast<std::uint16_t>(ranges);
        entry.triangles = ranges * kRangeTriangles;
        entry.level = kFullLevel;
        node.firstEntry = static_cast<std::uint32_t>(hierarchy.entries.size()), node.entryCount = 1;
        hierarchy.entries.push_back(entry);
        PageRecord page{};
        page.rangeCount = ranges, page.indexCount = 3 * entry.triangles;
        hierarchy.pages.push_back(page);
        PageTable& table = tables.emplace_back();
        table.origin = box.min;
        for (std::uint32_t r = 0; r < ranges; ++r) {
            Range range{3 * kRangeTriangles * r, 3 * kRangeTriangles, kRootPath, {}, {}};
            for (int axis = 0; axis < 3; ++axis) {
                const auto length = static_cast<glm::length_t>(axis);
                node.ownMin[axis] = box.min[length], node.ownMax[axis] = box.max[length];
                range.boxMax[axis] = static_cast<std::uint32_t>(box.max[length] - box.min[length]);
            }
            range.boxMin[2] = range.boxMax[2] * r / ranges;
            range.boxMax[2] = range.boxMax[2] * (r + 1) / ranges;
            table.ranges.push_back(range);
        }
    }

    // Leaves whose corner has this x, in leaves from 0.
    void setOpacity(std::int64_t x, std::uint8_t opacity) {
        for (NodeRecord& node : hierarchy.nodes)
            if (Hierarchy::isLeaf(node) && node.boxMin[0] == x * kLeafEdge)
                std::ranges::fill(node.opacity, opacity);
    }
    std::vector<EntryPriority> priorities(const TileSight& sight, double rays = 0.01) const {
        return entryPriorities(hierarchy, cells, cut, sight, rays, workers);
    }
    // What arrives on average at the leaves of a layer, by ray.
    double meanOfLayer(std::int64_t x, const TileSight& sight) const {
        double rays = 0, contribution = 0;
        for (const EntryPriority& p : priorities(sight)) {
            if (hierarchy.nodes[p.node].boxMin[0] != x * kLeafEdge) continue;
            rays += p.rays, contribution += p.contribution;
        }
        return contribution / rays;
    }
    std::vector<PlpRange> ranked(const TileSight& sight, std::uint64_t budget) const {
        const PlpVisibility plp(hierarchy, budget, 0.01, workers);
        return plp.ranges(
            plp.candidates(cut, sight), [&](std::uint32_t page) { return &tables[page]; }, sight);
    }
    // What is drawn when no look tells anything, in the order of frustum mode.
    std::vector<VisibleRanges> choose(const TileSight& sight, std::uint64_t budget) const {
        const std::vector<PlpRange> ranges = ranked(sight, budget);
        std::vector<PlpSpending::Range> open;
        for (const PlpRange& range : ranges)
            open.push_back({static_cast<std::uint32_t>(open.size()), range.triangles, {0, 0, 1, 1, 0}});
        std::vector<VisibleRanges> chosen;
        PlpSpending spending(open, budget);
        do {
            for (const PlpSpending::Taken& taken : spending.step())
                chosen.push_back({ranges[taken.number].page, ranges[taken.number].range, 1});
        } while (!spending.done());
        chosen = joined(std::move(chosen));
        FrustumVisibility(hierarchy).sortFrontToBack(chosen, sight.eye);
        return chosen;
    }
};

using Ids = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // page, range

Ids idsOf(const std::vector<VisibleRanges>& chosen) {
    Ids ids;
    for (const VisibleRanges& v : chosen)
        for (std::uint32_t r = v.firstRange; r < v.firstRange + v.rangeCount; ++r)
            ids.emplace_back(v.page, r);
    return ids;
}

const glm::dvec3 kOutside(-400, 130, 127);
const glm::dvec3 kAhead(1, 0, 0);

TEST(EntryPriorityTest, WhatIsEmptyHidesNothing) {
    const Grid grid(0);
    for (const EntryPriority& p : grid.priorities(sightFrom(kOutside, kAhead)))
        EXPECT_FLOAT_EQ(p.contribution, p.rays);
}

TEST(EntryPriorityTest, AWallHidesWhatIsBehindIt) {
    Grid grid(0);
    grid.setOpacity(1, 255);
    const TileSight sight = sightFrom(kOutside, kAhead);
    EXPECT_FLOAT_EQ(static_cast<float>(grid.meanOfLayer(0, sight)), 1);
    EXPECT_GT(grid.meanOfLayer(1, sight), 0.9);  // its sides are seen through the wall itself
    EXPECT_LT(grid.meanOfLayer(2, sight), 0.05);
    EXPECT_LT(grid.meanOfLayer(3, sight), 0.05);
}

// Rays along an axis cross all of each cell: each layer lets 1 - a through.
TEST(EntryPriorityTest, OpacityIsThatOfTheWayAcrossACell) {
    const Grid grid(128);
    const TileSight sight = sightFrom({-40000, 128, 128}, kAhead, 100, 100, 0.2);
    const double through = 1 - 128.0 / 255;
    for (int layer = 0; layer < 4; ++layer)
        EXPECT_NEAR(grid.meanOfLayer(layer, sight), std::pow(through, layer), 0.02) << layer;
}

TEST(EntryPriorityTest, AnInteriorNodeGetsWhatArrivesAtItsOwnTriangles) {
    Grid grid(255);
    grid.giveTriangles(grid.hierarchy.nodes[0], {LatticePoint(0), LatticePoint(256)}, 1);
    grid.update();
    const std::vector<EntryPriority> found = grid.priorities(sightFrom(kOutside, kAhead));
    const auto root = std::ranges::find(found, 0u, &EntryPriority::node);
    ASSERT_NE(root, found.end());
    EXPECT_GT(root->rays, 0);
    EXPECT_FLOAT_EQ(root->contribution, root->rays);
}

TEST(EntryPriorityTest, FewRaysMissNobodyInView) {
    const Grid grid(0);
    const std::vector<EntryPriority> found = grid.priorities(sightFrom(kOutside, kAhead), 1e-9);
    EXPECT_EQ(found.size(), 64u);
    for (const EntryPriority& p : found) EXPECT_GT(p.contribution, 0) << p.node;
}

TEST(RayGridTest, RaysParallelToAnAxis) {
    ScreenProjection projection;  // all pixels look along z
    projection.toDirection = glm::dmat3(glm::dvec3(0), glm::dvec3(0), glm::dvec3(0, 0, 1));
    projection.toPixels = glm::dmat3(1);
    RayGrid rays(projection, {0, 0, 8, 8}, 1, 1);
    const EyeBox ahead{glm::vec3(-1, -1, 5), glm::vec3(1, 1, 6)},
        aside{glm::vec3(0.1f, 0, 5), glm::vec3(1, 0, 6)};
    const EyeBox behind{glm::vec3(-1, -1, 7), glm::vec3(1, 1, 8)};
    const std::vector<RayGrid::Pass> passes{{ahead, 0}, {aside, 0}, {ahead, std::log(2.0f)}, {behind, 0}};
    Workers workers(1);
    const auto arrivals = rays.cross(passes, workers);
    EXPECT_EQ(arrivals[0].rays, 1);  // of the cells it meets
    EXPECT_EQ(arrivals[1].rays, 0);
    EXPECT_NEAR(arrivals[2].contribution, 1, 1e-6);
    EXPECT_NEAR(arrivals[3].contribution, 0.5, 1e-4);
}

TEST(RayGridTest, BoxesWithoutVolumeAndBoxesAnywhere) {
    const TileSight sight = sightFrom({0, 0, 0}, kAhead);
    RayGrid rays(sight.projection, sight.tile, sight.near, 0.01);
    Workers workers(1);
    const float huge = 4e18f;
    for (const EyeBox& box :
         {EyeBox{glm::vec3(0), glm::vec3(0)}, EyeBox{glm::vec3(9, 1, 1), glm::vec3(9, 1, 1)},
          EyeBox{glm::vec3(9, -9, -9), glm::vec3(9, 9, 9)}, EyeBox{glm::vec3(-9), glm::vec3(9)},
          EyeBox{glm::vec3(-9), glm::vec3(-8)}, EyeBox{glm::vec3(-huge), glm::vec3(huge)},
          EyeBox{glm::vec3(huge), glm::vec3(huge)}})
        for (const float density : {0.0f, 1.0f, 1e30f}) {
            const RayGrid::Pass pass{box, density};
            const RayGrid::Arrival arrival = rays.cross({&pass, 1}, workers).front();
            EXPECT_TRUE(std::isfinite(arrival.contribution)) << box.low.x << ' ' << box.high.x;
            EXPECT_GE(arrival.contribution, 0);
            EXPECT_LE(arrival.rays, 40 * 30);
        }
}

// Bit by bit, in grids of fewer rows than bands, too.
TEST(RayGridTest, TheNumberOfThreadsMakesNoDifference) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-30, 30), size(0, 9);
    std::vector<RayGrid::Pass> passes;
    for (int i = 0; i < 3000; ++i) {
        const glm::vec3 low(20 + place(random) / 2, place(random), place(random));
        passes.push_back(
            {{low, low + glm::vec3(size(random), size(random), size(random))}, size(random) / 99});
    }
    const TileSight sight = sightFrom({0, 0, 0}, kAhead);
    for (const double raysPerPixel : {0.01, 0.0001}) {
        const RayGrid fresh(sight.projection, sight.tile, sight.near, raysPerPixel);
        const auto cross = [&](unsigned threads) {
            Workers workers(threads);
            return RayGrid(fresh).cross(passes, workers);
        };
        const std::vector<RayGrid::Arrival> alone = cross(1);
        for (const unsigned threads : {2u, 3u, 4u}) EXPECT_EQ(cross(threads), alone) << threads;
    }
}

TEST(PlpVisibilityTest, TheBudgetIsKeptAndUsed) {
    const Grid grid(60);
    for (const std::uint64_t budget : {1000u, 1234u, 5000u, 12800u}) {
        const auto chosen = idsOf(grid.choose(sightFrom(kOutside, kAhead), budget)).size() * kRangeTriangles;
        EXPECT_LE(chosen, budget);
        EXPECT_GT(chosen + kRangeTriangles, budget);
    }
}

TEST(PlpVisibilityTest, ABudgetTooSmallForARangeDrawsNothing) {
    EXPECT_TRUE(Grid(60).choose(sightFrom(kOutside, kAhead), kRangeTriangles - 1).empty());
}

// Everything that frustum mode draws, in the same order.
TEST(PlpVisibilityTest, WithEnoughBudgetNothingIsMissing) {
    Grid grid(255);
    grid.giveTriangles(grid.hierarchy.nodes[0], {LatticePoint(0), LatticePoint(256)}, 3);
    grid.update();
    const FrustumVisibility frustum(grid.hierarchy);
    for (const glm::dvec3& eye : {kOutside, glm::dvec3(130, 100, 90), glm::dvec3(-60, -70, -80)}) {
        const TileSight sight = sightFrom(eye, {1, 0.3, 0.2}, 200, 150, 40);
        Ids wanted;
        for (const VisibleRanges& v : frustum.visible(grid.cut, sight.frustum(), sight.eye))
            forRangesIn(grid.tables[v.page], v.firstRange, v.rangeCount, sight.frustum(), sight.eye,
                        [&](std::uint32_t r, const glm::dvec3&, const glm::dvec3&) {
                            wanted.emplace_back(v.page, r);
                        });
        EXPECT_FALSE(wanted.empty());
        EXPECT_EQ(idsOf(grid.choose(sight, 1u << 30)), wanted);
    }
}

TEST(PlpVisibilityTest, WhatIsInFrontComesFirst) {
    Grid grid(0);
    grid.setOpacity(0, 255);
    std::set<std::uint32_t> front;
    for (const NodeRecord& node : grid.hierarchy.nodes)
        if (Hierarchy::isLeaf(node) && node.boxMin[0] == 0)
            front.insert(grid.hierarchy.entries[node.firstEntry].firstPage);
    const Ids chosen = idsOf(grid.choose(sightFrom(kOutside, kAhead), 16 * kRanges * kRangeTriangles));
    const auto inFront =
        std::ranges::count_if(chosen, [&](const auto& id) { return front.contains(id.first); });
    EXPECT_GE(inFront, 60);
}

TEST(PlpVisibilityTest, TheSameViewGivesTheSame) {
    const Grid grid(100);
    const TileSight sight = sightFrom({100, 90, 80}, {1, 0.5, 0.1});
    EXPECT_EQ(idsOf(grid.choose(sight, 4000)), idsOf(grid.choose(sight, 4000)));
}

TEST(PlpVisibilityTest, NothingInViewAndFarAway) {
    const Grid grid(100);
    EXPECT_TRUE(grid.choose(sightFrom(kOutside, {-1, 0, 0}), 5000).empty());
    EXPECT_TRUE(grid.choose(sightFrom({-0x1p60, 0, 0}, {0, 1, 0}), 5000).empty());
    EXPECT_LE(idsOf(grid.choose(sightFrom({-0x1p40, 128, 128}, kAhead), 5000)).size(), 50u);
    EXPECT_FALSE(grid.choose(sightFrom({-0x1p40, 128, 128}, kAhead), 5000).empty());
}

TEST(PlpVisibilityTest, WithoutATableRangesAreLeftOut) {
    const Grid grid(0);
    const PlpVisibility plp(grid.hierarchy, 1u << 20, 0.01, grid.workers);
    const TileSight sight = sightFrom(kOutside, kAhead);
    const auto candidates = plp.candidates(grid.cut, sight);
    EXPECT_EQ(plp.pagesOf(candidates).size(), 64u);
    const auto table = [&](std::uint32_t page) { return page == 7 ? nullptr : &grid.tables[page]; };
    const std::vector<PlpRange> ranges = plp.ranges(candidates, table, sight);
    EXPECT_EQ(ranges.size(), 63 * kRanges);
    EXPECT_TRUE(std::ranges::none_of(ranges, [](const PlpRange& range) { return range.page == 7; }));
}

TEST(PlpVisibilityTest, CandidatesAreSeveralTimesTheBudget) {
    const Grid grid(0);
    const PlpVisibility plp(grid.hierarchy, 1000, 0.01, grid.workers);
    EXPECT_EQ(plp.candidates(grid.cut, sightFrom(kOutside, kAhead)).size(), 15u);  // 6000 triangles
}

TEST(PlpVisibilityTest, ATreeOfOneLeaf) {
    Grid grid;
    grid.hierarchy.nodes.clear(), grid.hierarchy.entries.clear(), grid.hierarchy.pages.clear();
    grid.tables.clear();
    NodeRecord& root = grid.addNode(LatticePoint(0), 0);
    grid.giveTriangles(root, {LatticePoint(0), LatticePoint(256)}, 2);
    grid.update();
    EXPECT_EQ(idsOf(grid.choose(sightFrom(kOutside, kAhead), 1000)), (Ids{{0, 0}, {0, 1}}));
    EXPECT_EQ(idsOf(grid.choose(sightFrom({128, 128, 128}, kAhead), 1000)).size(), 2u);
}

// What stands for all below a node is chosen in its place.
TEST(PlpVisibilityTest, CutsOfCoarseLevels) {
    const Hierarchy hierarchy = makeHierarchy();
    Workers workers(1);
    const PlpVisibility plp(hierarchy, 1000, 0.01, workers);
    const auto entries = [&](unsigned level) {
        std::set<std::uint32_t> found;
        const TileSight sight = sightFrom({-400, 0, 0}, kAhead);
        for (const auto& candidate : plp.candidates(cutAtLevel(hierarchy, level), sight))
            found.insert(candidate.entry);
        return found;
    };
    EXPECT_EQ(entries(0), (std::set<std::uint32_t>{0}));
    EXPECT_EQ(entries(1), (std::set<std::uint32_t>{1, 3, 5, 6}));
    EXPECT_EQ(entries(kFullLevel), (std::set<std::uint32_t>{2, 4, 5, 8}));
}

}  // namespace
}  // namespace iwalk
