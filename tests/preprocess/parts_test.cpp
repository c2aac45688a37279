// The builder's small parts by themselves.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "common/dataset/page.hpp"
#include "preprocess/build/budget.hpp"
#include "preprocess/build/grid.hpp"
#include "preprocess/build/order.hpp"
#include "preprocess/build/spill.hpp"
#include "preprocess/build/survey.hpp"
#include "preprocess/build/tree.hpp"
#include "preprocess/import/memory_share.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk {
namespace {

TEST(GridTest, BinsAreInPreorder) {
    constexpr unsigned kRoot = 10;  // cells of 1024, 512, 256 and 128 steps
    EXPECT_EQ(binOf({CellPoint(1023), 0}, 0, kRoot), 0u);
    EXPECT_EQ(binOf({CellPoint(0), 1}, 0, kRoot), 1u);
    EXPECT_EQ(binOf({CellPoint(511, 511, 511), 2}, 0, kRoot), 2u + 7 * 9);
    EXPECT_EQ(binOf({CellPoint(128, 0, 0), 3}, 0, kRoot), 4u);
    EXPECT_EQ(binOf({CellPoint(0, 0, 512), 9}, 0, kRoot), 3u + 4 * 73);
    EXPECT_EQ(binOf({CellPoint(1023), 10}, 0, kRoot), 584u);
    EXPECT_EQ(binOf({CellPoint(1023), 10}, 8, kRoot), 2u + 7 * 73 + 7 * 9);  // two levels are left
}

TEST(GridTest, DepthFollowsSize) {
    const auto depth = [](std::uint64_t size) {
        return placeOf(CellPoint(0), CellPoint(size, 0, 0), CellPoint(0, 0, 0), 10).depth;
    };
    EXPECT_EQ(depth(1), 10u);
    EXPECT_EQ(depth(2), 9u);
    EXPECT_EQ(depth(3), 8u);
    EXPECT_EQ(depth(512), 1u);
    EXPECT_EQ(depth(513), 0u);
}

TEST(GridTest, PlanSplitsWhatIsTooMuch) {
    std::vector<std::uint64_t> counts(kGridBins, 0);
    counts[0] = 3;  // large ones at the root
    counts[1] = 5;  // first child: 5 + 6
    counts[4] = 6;
    counts[584] = 20;  // in the last corner
    const auto plan = planGrid(counts, 11, OldTree(), OldTree::kNone);
    ASSERT_EQ(plan.size(), 5u);
    EXPECT_EQ(plan[0].kind, PlannedNode::kInterior);
    EXPECT_EQ(plan[1].kind, PlannedNode::kLeaf);
    EXPECT_EQ(plan[1].binCount, 73u);
    EXPECT_EQ(plan[2].octant, 7);
    EXPECT_EQ(plan[3].parent, 2u);
    EXPECT_EQ(plan[4].kind, PlannedNode::kSubtree);
    EXPECT_EQ(plan[4].firstBin, 584u);
    EXPECT_EQ(planGrid(counts, 34, OldTree(), OldTree::kNone).size(), 1u);
}

TEST(OrderTest, RangesEndAtCells) {
    std::vector<std::uint64_t> keys;
    for (std::uint64_t cell = 0; cell < 8; ++cell) {
        for (std::uint64_t i = 0; i < 300; ++i) keys.push_back(cell << 50 | i);
    }
    // A node of 2^16 steps: three bits of a key for each level, the highest at 51.
    const std::vector<CellRun> octants = cutRanges(keys, 16);
    ASSERT_EQ(octants.size(), 8u);
    for (std::uint32_t cell = 0; cell < 8; ++cell) {
        EXPECT_EQ(octants[cell].end, 300 * (cell + 1));
        EXPECT_EQ(octants[cell].path >> 3 * (pathLevels(octants[cell].path) - 2),
                  0x40u | cell >> 1 << 3 | (cell & 1) << 2);
    }
    EXPECT_EQ(cutRanges({}, 16), std::vector<CellRun>{});
}

// The deepest cell that has all: a run of few triangles does not spread over the node.
TEST(OrderTest, RangesKnowTheirCells) {
    const auto key = [](std::uint64_t octants, unsigned levels) {
        return octants << (kKeyBits - 3 * levels);
    };
    EXPECT_EQ(cutRanges(std::vector{key(025, 2), key(027, 2)}, 16), (std::vector<CellRun>{{2, 012}}));
    EXPECT_EQ(cutRanges(std::vector{key(025, 2), key(037, 2)}, 16), (std::vector<CellRun>{{2, 1}}));
    // Where paths end nothing tells triangles apart.
    const std::uint32_t last = 1u << 30;
    EXPECT_EQ(cutRanges(std::vector<std::uint64_t>(1000, 7), 16),
              (std::vector<CellRun>{{500, last}, {1000, last}}));
    EXPECT_EQ(cutRanges(std::vector<std::uint64_t>(512, 7), 16), (std::vector<CellRun>{{512, last}}));
    // In a node of 4 steps they end early.
    EXPECT_EQ(cutRanges(std::vector<std::uint64_t>(3, 052 << 6), 2), (std::vector<CellRun>{{3, 0152}}));
}

// A cell that goes on on the page before or after is split down to where the pages part.
TEST(OrderTest, RangesEndWherePagesDo) {
    const auto key = [](std::uint64_t octants) { return octants << (kKeyBits - 9); };
    const std::vector<std::uint64_t> keys{key(0311), key(0312), key(0320), key(0370)};
    EXPECT_EQ(cutRanges(keys, 16), (std::vector<CellRun>{{4, 013}}));
    const KeysAround around{.before = key(0310), .after = key(0375)};
    const std::vector<CellRun> runs = cutRanges(keys, 16, 0, around);
    ASSERT_EQ(runs.size(), 4u);
    for (const CellRun& run : runs) EXPECT_EQ(pathLevels(run.path), kMaxPathLevels);
    EXPECT_EQ(cutRanges(keys, 16, 0, {.before = key(0200), .after = std::nullopt}),
              (std::vector<CellRun>{{4, 013}}));
}

TEST(OrderTest, SortsByKeyAndKeepsTies) {
    std::mt19937 random(1);
    const RecordFormat format(20, false, false);
    std::vector<std::uint32_t> records;
    for (int i = 0; i < 5000; ++i) {
        const std::uint64_t at = random() % 4096;  // few, so that there are ties
        TriangleRecord triangle{
            {CellPoint(at, at, at), CellPoint(at + 3, at, at), CellPoint(at, at + 3, at)}};
        records.resize(records.size() + format.words());
        format.pack(triangle, records.data() + records.size() - format.words());
    }
    for (const std::size_t count : {std::size_t{5000}, std::size_t{100}}) {
        std::vector<std::uint32_t> order(count);
        std::iota(order.begin(), order.end(), 0u);
        sortByKey(format, records.data(), 20, order);
        for (std::size_t i = 1; i < count; ++i) {
            const auto key = [&](std::uint32_t r) {
                return sortKey(format.place(records.data() + r * 9), 20);
            };
            EXPECT_LE(std::pair(key(order[i - 1]), order[i - 1]), std::pair(key(order[i]), order[i]));
        }
    }
}

TEST(SpillTest, BinsComeBackInOrderAndChunksAreReused) {
    const TempDirectory directory;
    auto file = ChunkFile::create(directory.path("spill"), 64);
    ASSERT_TRUE(file.ok());
    EXPECT_EQ(directory.list(), std::vector<std::string>{});
    for (int round = 0; round < 3; ++round) {
        BinWriter writer(*file, 5, 3);
        for (std::uint32_t i = 0; i < 1000; ++i) {
            std::uint32_t* const record = writer.append(i % 7 % 5).value();
            record[0] = i, record[1] = i + 1, record[2] = i + 2;
        }
        std::vector<Bin> bins = writer.finish().value();
        for (std::size_t b = 0; b < bins.size(); ++b) {
            std::vector<std::uint32_t> words;
            for (BinReader reader(*file, std::move(bins[b]), 3); reader.left() > 0;) {
                ASSERT_TRUE(reader.next(words).ok());
            }
            std::vector<std::uint32_t> wanted;
            for (std::uint32_t i = 0; i < 1000; ++i) {
                if (i % 7 % 5 == b) wanted.insert(wanted.end(), {i, i + 1, i + 2});
            }
            EXPECT_EQ(words, wanted);
        }
    }
    EXPECT_LT(file->write(std::vector<std::byte>(64)).value(),
              205u);  // 1000 records of 12 bytes, five to a chunk
}

TEST(SurveyTest, SampleIsEvenAndDoesNotDependOnBatches) {
    std::vector<glm::dvec3> positions;
    for (int i = 0; i < 100'000; ++i) positions.emplace_back(i, 0, 0);
    Sample whole, pieces;
    whole.add(positions);
    for (std::size_t at = 0; at < positions.size();) {
        const std::size_t count = std::min(positions.size() - at, 1 + at % 999);
        pieces.add(std::span(positions).subspan(at, count));
        at += count;
    }
    EXPECT_EQ(whole.positions(), pieces.positions());
    EXPECT_GT(whole.positions().size(), 8000u);
    const double every = whole.positions()[1].x;
    for (std::size_t i = 0; i < whole.positions().size(); ++i) {
        EXPECT_EQ(whole.positions()[i].x, static_cast<double>(i) * every);
    }
}

int stepFor(double size, double precision) {
    Sample sample;
    ImportSummary summary;
    for (int i = 0; i <= 100; ++i) {
        const glm::dvec3 p(size * i / 100, 0, 0);
        sample.add(std::span(&p, 1));
        summary.bounds.add(p);
    }
    summary.precision = precision;
    return chooseLattice(std::span(&summary, 1), sample, std::nullopt).value().stepExponent;
}

TEST(SurveyTest, StepFollowsSizeAndPrecision) {
    EXPECT_EQ(stepFor(1, 0x1p-52), -24);
    EXPECT_EQ(stepFor(1000, 0x1p-42), 10 - 24);
    EXPECT_EQ(stepFor(1, 0x1p-20), -20);    // no finer than the input
    EXPECT_EQ(stepFor(1, 0x1.8p-20), -19);  // rounded up
    EXPECT_EQ(stepFor(1e-300, 0), -1000);   // as far as it goes
    Sample sample;
    const ImportSummary nothing;
    EXPECT_FALSE(chooseLattice(std::span(&nothing, 1), sample, std::nullopt).ok());
}

TEST(BudgetTest, PartsStayBelowTheWhole) {
    for (const std::uint64_t mebibytes : {64u, 100u, 512u, 8192u}) {
        for (const unsigned threads : {1u, 2u, 64u}) {
            BuildOptions options;
            options.memoryBytes = mebibytes << 20;
            options.threads = threads;
            const Budget budget = makeBudget(options).value();
            EXPECT_LT(budget.importerBytes + kGridBins * budget.chunkBytes, options.memoryBytes);
            EXPECT_GE(budget.importerBytes, 16u << 20);
            EXPECT_GE(budget.importerBytes, kLeastImporterBytes);
            EXPECT_GE(budget.chunkBytes, 4096u);
            EXPECT_GE(budget.batchBytes, 12u << 20);
            EXPECT_GE(budget.threads, 1u);
            EXPECT_LE(budget.threads, threads);
        }
    }
}

TEST(TreeTest, ChildrenStandInRows) {
    Tree tree;
    const std::uint32_t root = tree.add(Tree::kNone, 0, 0);
    const std::uint32_t seven = tree.add(root, 7, 1);
    const std::uint32_t deep = tree.add(seven, 3, 2);
    const std::uint32_t two = tree.add(root, 2, 1);
    const auto own = [&](std::uint32_t node, std::uint32_t at) {
        setOwnBox(tree[node], LatticeBox{LatticePoint(at), LatticePoint(at + 1)});
        tree.fullEntry(node).triangles = at;
    };
    own(deep, 10), own(two, 5);
    const auto [nodes, entries, finest, origin] = tree.finish();
    EXPECT_EQ(origin, std::vector<std::uint32_t>(4, Tree::kNone));
    ASSERT_EQ(nodes.size(), 4u);
    EXPECT_EQ(finest, (std::vector<int>{-1, 0, 0, 1}));
    EXPECT_EQ(nodes[0].childMask, 0b10000100);
    EXPECT_EQ(nodes[0].firstChild, 1u);
    ASSERT_EQ(entries.size(), 2u);
    EXPECT_EQ(nodes[0].entryCount, 0u);
    EXPECT_EQ(nodes[1].firstEntry, 0u);
    EXPECT_EQ(entries[0].triangles, 5u);  // octant 2 before octant 7
    EXPECT_EQ(nodes[2].firstEntry, 1u);
    EXPECT_EQ(nodes[3].entryCount, 1u);
    EXPECT_EQ(entries[1].level, kFullLevel);
    EXPECT_EQ(nodes[2].firstChild, 3u);
    EXPECT_EQ(Hierarchy::box(nodes[0]), (LatticeBox{LatticePoint(5), LatticePoint(11)}));
    EXPECT_EQ(Hierarchy::box(nodes[2]), (LatticeBox{LatticePoint(10), LatticePoint(11)}));
    EXPECT_EQ(Hierarchy::ownBox(nodes[2]), LatticeBox{});
}

}  // namespace
}  // namespace iwalk
