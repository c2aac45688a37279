// The small parts of making levels by themselves: how space is cut, how ranges nest, which points are near.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "preprocess/build/grid.hpp"
#include "preprocess/levels/cell_runs.hpp"
#include "preprocess/levels/cells.hpp"
#include "preprocess/levels/near_points.hpp"

namespace iwalk {
namespace {

constexpr unsigned kRoot = 20;  // edge of 2^20 steps
constexpr std::uint64_t kEdge = std::uint64_t{1} << kRoot;

class CutCellsTest : public testing::Test {
  protected:
    CutCellsTest() {
        for (int i = 0; i < 300; ++i) {
            const unsigned edgeLog2 = 10 + static_cast<unsigned>(below(5));
            const std::uint64_t edge = std::uint64_t{1} << edgeLog2;
            const CellPoint low(below(kEdge >> edgeLog2), below(kEdge >> edgeLog2) / 4,
                                below(kEdge >> edgeLog2));
            weights_.push_back({lattice_.fromCell(low * edge), edge, 1 + below(20'000)});
        }
    }
    std::uint64_t below(std::uint64_t end) { return random_() % end; }
    std::vector<LatticeCell> cut(int errorLog2) const {
        return cutCells(weights_, errorLog2, {65536, 2000, ~0ull});
    }
    std::vector<SpaceCell> inside(std::span<const LatticeCell> cells) const {
        std::vector<SpaceCell> found;
        for (const LatticeCell& cell : cells) {
            if (const auto part = inRoot(cell, lattice_)) found.push_back(*part);
        }
        return found;
    }

    std::mt19937_64 random_{1};
    const Lattice lattice_{0, LatticePoint(-300'000, 5, 1'000'000), kRoot};
    std::vector<Weight> weights_;
};

TEST_F(CutCellsTest, EveryPointIsInExactlyOne) {
    for (const int errorLog2 : {-3, 0, 13}) {
        const std::vector<SpaceCell> cells = inside(cut(errorLog2));
        EXPECT_GT(cells.size(), 20u);
        for (int i = 0; i < 5000; ++i) {
            CellPoint p(below(kEdge), below(kEdge), below(kEdge));
            if (i % 2 == 0) {  // a corner of a cell, where they meet
                const SpaceCell& cell = cells[below(cells.size())];
                for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = std::min(cell.low[axis], kEdge - 1);
            }
            const auto holds = [&](const SpaceCell& cell) { return cell.contains(p); };
            ASSERT_EQ(std::ranges::count_if(cells, holds), 1) << p.x << ' ' << p.y << ' ' << p.z;
        }
    }
}

TEST_F(CutCellsTest, AreAsLargeAsAsked) {
    for (const std::uint64_t least : {std::uint64_t{2000}, kEdge / 4}) {
        for (const LatticeCell& cell : cutCells(weights_, 3, {65536, least, ~0ull})) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                EXPECT_GE(cell.high[axis] - cell.low[axis], static_cast<std::int64_t>(least));
            }
        }
    }
    for (const LatticeCell& cell : cutCells(weights_, 3, {~0ull, 1, kEdge / 16})) {
        const auto isInside = [&](const Weight& weight) {
            const LatticePoint middle = weight.low + static_cast<std::int64_t>(weight.edge / 2);
            return LatticeBox{cell.low, cell.high}.contains(LatticeBox{middle, middle});
        };
        if (std::ranges::none_of(weights_, isInside)) continue;
        EXPECT_LE(cell.high.x - cell.low.x, static_cast<std::int64_t>(kEdge / 16));
    }
    EXPECT_GT(inside(cutCells(weights_, 3, {10'000, 2000, ~0ull})).size(), 2 * inside(cut(3)).size());
}

TEST_F(CutCellsTest, DoNotDependOnTheOrderOfWeights) {
    const std::vector<LatticeCell> before = cut(2);
    std::ranges::shuffle(weights_, random_);
    EXPECT_TRUE(before == cut(2));
}

// What is held at a border of one level is free in the next two.
TEST_F(CutCellsTest, PlanesOfNeighbouringLevelsLieApart) {
    for (const int other : {5, 6}) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (const LatticeCell& a : cut(4)) {
                for (const LatticeCell& b : cut(other)) {
                    const std::int64_t edge = std::min(a.high.x - a.low.x, b.high.x - b.low.x);
                    ASSERT_GE(std::abs(a.low[axis] - b.low[axis]), edge / 6);
                }
            }
        }
    }
}

// More triangles split cells that they lie in, and change no others.
TEST_F(CutCellsTest, ChangesAreLocal) {
    const std::vector<LatticeCell> before = cut(7);
    const Weight more{lattice_.fromCell(CellPoint(kEdge / 2)), 1024, 90'000};
    weights_.push_back(more);
    const std::vector<LatticeCell> after = cut(7);
    std::size_t gone = 0;
    for (const LatticeCell& cell : before) {
        if (std::ranges::count(after, cell) == 1) continue;
        ++gone;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_LT(cell.low[axis], more.low[axis] + 1024);
            EXPECT_GT(cell.high[axis], more.low[axis]);
        }
    }
    EXPECT_GE(gone, 1u);
}

TEST(CutCellsOfLittleTest, OneCellIsEnough) {
    const Lattice lattice{0, LatticePoint(-7), 10};
    const std::vector<Weight> one{{LatticePoint(5), 1, 1}};
    ASSERT_EQ(cutCells(one, 0, {65536, 16, ~0ull}).size(), 1u);
    ASSERT_EQ(cutCells({}, 0, {1, 1, ~0ull}).size(), 1u);
    const SpaceCell cell = inRoot(cutCells(one, 0, {65536, 16, ~0ull})[0], lattice).value();
    EXPECT_EQ(cell.low, CellPoint(0));
    EXPECT_EQ(cell.high, CellPoint(1024));
}

class JoinRangesTest : public testing::Test {
  protected:
    // Cells of different sizes that fill the entry's, in Morton order.
    void addCells(std::uint64_t octants, unsigned levels) {
        if (levels < 2 || (levels < 6 && random_() % 3 == 0)) {
            for (std::uint64_t octant = 0; octant < 8; ++octant) addCells(octants << 3 | octant, levels + 1);
            return;
        }
        const auto corner = static_cast<std::int64_t>(sources_.size());
        const std::size_t triangles = random_() % 4 == 0 ? 0 : random_() % 500;
        sources_.push_back({octants << (kMortonKeyBits - 3 * levels),
                            levels,
                            triangles,
                            {LatticePoint(corner), LatticePoint(corner + 3)}});
    }
    // The first key of a cell, and the first beyond it.
    static std::pair<std::uint64_t, std::uint64_t> keysOf(std::uint32_t path) {
        const unsigned levels = pathLevels(path);
        const std::uint64_t octants = path ^ std::uint64_t{1} << 3 * levels;
        const unsigned shift = kMortonKeyBits - 3 * levels;
        return {octants << shift, (octants + 1) << shift};
    }
    std::mt19937 random_{1};
    std::vector<RunSource> sources_;
};

TEST_F(JoinRangesTest, HaveAllInOrder) {
    addCells(0, 0);
    const std::vector<iwalk::Run> runs = joinRanges(sources_, 2);
    std::size_t begin = 0, source = 0, passed = 0;
    std::uint64_t last = 0;
    for (const iwalk::Run& run : runs) {
        EXPECT_GT(run.end, begin);
        EXPECT_LE(run.end - begin, kMaxRangeTriangles);
        const auto [low, high] = keysOf(run.path);
        EXPECT_GE(low, last);
        last = high;
        // The sources whose triangles it has.
        for (; source < sources_.size() && passed + sources_[source].triangles <= run.end; ++source) {
            passed += sources_[source].triangles;
            if (sources_[source].triangles == 0) continue;
            EXPECT_TRUE(sources_[source].key >= low && sources_[source].key < high);
            EXPECT_TRUE(run.box.contains(sources_[source].box));
        }
        begin = run.end;
    }
    EXPECT_EQ(source, sources_.size());
    EXPECT_EQ(runs.back().end, passed);
}

// A level's ranges are made of those of the finer one; none of these reaches out of its own.
TEST_F(JoinRangesTest, Nest) {
    addCells(0, 0);
    for (unsigned least = 4; least-- > 0;) {
        const std::vector<iwalk::Run> runs = joinRanges(sources_, least);
        ASSERT_FALSE(runs.empty());
        LatticeBox all, joined;
        for (const RunSource& source : sources_) {
            all.add(source.box);
            const auto after = std::ranges::upper_bound(
                runs, source.key, {}, [](const iwalk::Run& run) { return keysOf(run.path).first; });
            const iwalk::Run& run = after == runs.begin() ? runs.front() : *std::prev(after);
            EXPECT_TRUE(run.box.contains(source.box));
            EXPECT_TRUE(source.triangles == 0 || pathLevels(run.path) <= source.levels);
        }
        std::vector<RunSource> coarser;
        std::size_t begin = 0;
        for (const iwalk::Run& run : runs) {
            joined.add(run.box);
            const std::size_t left = (run.end - begin) / 3;
            coarser.push_back({keysOf(run.path).first, pathLevels(run.path), left, run.box});
            begin = run.end;
        }
        EXPECT_EQ(joined, all);
        EXPECT_LT(coarser.size(), sources_.size());
        sources_ = std::move(coarser);
    }
}

// Where cells cannot be split there are several ranges of one cell, as few as do.
TEST_F(JoinRangesTest, OneCellMayHaveSeveral) {
    for (int i = 0; i < 5; ++i) sources_.push_back({0, 0, 300, {LatticePoint(i), LatticePoint(i)}});
    const std::vector<iwalk::Run> runs = joinRanges(sources_, 0);
    ASSERT_EQ(runs.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(runs[i].path, 1u);
        EXPECT_EQ(runs[i].end, 300 * (i + 1));
    }
}

TEST(NearPointsTest, FindsWhatIsNear) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> place(-10, 10);
    std::vector<glm::vec3> points;
    for (int i = 0; i < 2000; ++i) points.emplace_back(place(random), place(random), 0.1f * place(random));
    for (int i = 0; i < 100; ++i)
        points.push_back(points[static_cast<std::size_t>(i)]);  // no distance at all
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (i % 5 != 0) numbers.push_back(i);
    }
    for (const float most : {0.01f, 0.7f, 30.0f}) {
        const NearPoints near(points, numbers, most);
        for (std::uint32_t from = 0; from < points.size(); from += 71) {
            const float reach = from % 2 == 0 ? most : most / 3;
            std::vector<NearPoints::Found> wanted, found{{1.0f, 2u}};
            for (const std::uint32_t to : numbers) {
                const glm::vec3 way = points[to] - points[from];
                const float square = glm::dot(way, way);
                if (to != from && square <= reach * reach) wanted.emplace_back(std::sqrt(square), to);
            }
            std::ranges::sort(wanted);
            near.find(from, reach, found);
            EXPECT_EQ(found, wanted) << "from " << from << " within " << reach;
        }
    }
}

}  // namespace
}  // namespace iwalk
