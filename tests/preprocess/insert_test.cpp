// Datasets that models were inserted into: what must be the same as in a build of all at once is the same,
// what nothing touches stays, and the levels are as good as any.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <map>

#include "common/dataset/page_files.hpp"
#include "common/file.hpp"
#include "preprocess/build/compact.hpp"
#include "preprocess/build/verify.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/levels_models.hpp"
#include "tests/tools/levels/cracks.hpp"
#include "tests/tools/levels/report.hpp"

namespace iwalk {
namespace {

FakeInput placed(FakeInput input, double scale, const glm::dvec3& offset) {
    for (Triangle& triangle : input.triangles) {
        for (Corner& corner : triangle) corner.position = scale * corner.position + offset;
    }
    return input;
}

Result<Manifest> insertInto(const FakeInput& input, const std::string& dataset, const Chosen& chosen = {},
                            BuildParts parts = {}) {
    NoProgress progress;
    BuildOptions options;
    options.memoryBytes = chosen.memoryBytes;
    options.threads = chosen.threads;
    options.inputs = {"more.ply"};
    options.output = dataset;
    parts.openImporter = fakeImporters({{"more.ply", input}});
    return insertIntoDatasetFrom(options, progress, parts);
}

// A dataset in memory, with the bytes of its pages and morph blocks.
struct Loaded {
    Manifest manifest;
    Hierarchy hierarchy;
    std::vector<std::string> pages, morphs;
};

Loaded load(const std::string& dataset) {
    Loaded loaded;
    loaded.manifest = loadManifest(dataset).value();
    loaded.hierarchy = loadHierarchy(dataset, loaded.manifest).value();
    const PageFiles files = openPageFiles(dataset, loaded.manifest).value();
    const auto read = [&](std::size_t file, std::uint64_t offset, std::uint32_t bytes) {
        std::string text(bytes, '\0');
        EXPECT_TRUE(files[file]->readAt(offset, std::as_writable_bytes(std::span(text))).ok());
        return text;
    };
    for (const PageRecord& page : loaded.hierarchy.pages) {
        loaded.pages.push_back(read(page.file, page.offset, page.bytes));
        loaded.morphs.push_back(page.morphBytes > 0 ? read(page.morphFile, page.morphOffset, page.morphBytes)
                                                    : "");
    }
    return loaded;
}

// Of each node its depth, the lowest corner of its cell, and its own triangles of the input.
using NodeKey = std::array<std::int64_t, 5>;
std::vector<NodeKey> nodesOf(const Hierarchy& hierarchy) {
    const std::vector<LatticePoint> cells = cellsOfNodes(hierarchy);
    std::vector<NodeKey> nodes;
    for (std::size_t n = 0; n < cells.size(); ++n) {
        const NodeRecord& node = hierarchy.nodes[n];
        nodes.push_back({node.depth, cells[n].x, cells[n].y, cells[n].z, hierarchy.ownTriangles(node)});
    }
    return nodes;
}

class InsertTest : public testing::Test {
  protected:
    std::string path(const std::string& name) const { return directory_.path(name); }

    void build(const FakeInput& input, const std::string& name, std::uint32_t leafTriangles) {
        const auto manifest =
            buildFrom(input, path(name), {.leafTriangles = leafTriangles, .stepExponent = kStep});
        ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    }
    void insert(const FakeInput& input, const std::string& name, const Chosen& chosen = {},
                BuildParts parts = {}) {
        const auto manifest = insertInto(input, path(name), chosen, std::move(parts));
        ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    }
    void expectGood(const std::string& name) {
        NoProgress progress;
        const auto verified = verifyDataset(path(name), progress);
        ASSERT_TRUE(verified.ok()) << verified.error().message;
        EXPECT_EQ(verified->problems, std::vector<std::string>{});
    }
    // That `inserted` has the nodes, owners and triangles of a build of `all` in the same root's cell.
    void expectAsBuilt(const std::string& inserted, const FakeInput& all, std::uint32_t leafTriangles) {
        const Loaded got = load(path(inserted));
        BuildParts parts;
        parts.lattice = Lattice{kStep, got.hierarchy.rootCell, got.hierarchy.rootCellLog2};
        ASSERT_TRUE(
            buildFrom(all, path("all"), {.leafTriangles = leafTriangles, .stepExponent = kStep}, parts).ok());
        const Loaded wanted = load(path("all"));
        ASSERT_EQ(nodesOf(got.hierarchy), nodesOf(wanted.hierarchy));
        for (std::size_t n = 0; n < got.hierarchy.nodes.size(); ++n) {
            EXPECT_TRUE(
                std::ranges::equal(got.hierarchy.nodes[n].opacity, wanted.hierarchy.nodes[n].opacity));
        }
        EXPECT_TRUE(readTriangles(path(inserted)) == readTriangles(path("all")));
        EXPECT_EQ(got.manifest.bounds, wanted.manifest.bounds);
        expectGood(inserted);
    }
    levels::CrackReport cracks(const std::string& name) {
        const auto pages = levels::DatasetPages::open(path(name)).value();
        std::vector<double> errors;  // steps
        for (unsigned level = 0; level < pages.manifest().levels.size(); ++level) {
            errors.push_back(levelErrorSteps(pages.hierarchy().rootCellLog2, level));
        }
        return levels::countCracks(levels::loadRangeModel(pages).value(), errors, {.pairs = 40});
    }
    double worstError(const std::string& name) {
        const auto pages = levels::DatasetPages::open(path(name)).value();
        return levels::largestRatio(levels::measureErrors(pages, {.samples = 4000, .seed = 1}).value());
    }

    static constexpr int kStep = -20;
    TempDirectory directory_;
};

FakeInput together(FakeInput a, const FakeInput& b) {
    a.triangles.insert(a.triangles.end(), b.triangles.begin(), b.triangles.end());
    return a;
}

// What is inserted, and where.
struct InsertCase {
    std::string name;
    double scale;  // of the second model
    glm::dvec3 offset;
};
std::ostream& operator<<(std::ostream& out, const InsertCase& c) {
    return out << c.name;
}

class InsertPlacesTest : public InsertTest, public testing::WithParamInterface<InsertCase> {
  protected:
    void expectBothWays(const FakeInput& a, const FakeInput& b, std::uint32_t leafTriangles) {
        build(a, "d", leafTriangles);
        insert(b, "d");
        expectAsBuilt("d", together(a, b), leafTriangles);
    }
};

TEST_P(InsertPlacesTest, Soups) {
    const FakeInput b = placed(makeSoup(3000, 1e-4, 1, 2), GetParam().scale, GetParam().offset);
    expectBothWays(makeSoup(20'000, 1e-4, 2, 1), b, 200);
    expectBothWays(makeSoup(4000, 1e-3, 0.5, 3), b, 1000);
}

TEST_P(InsertPlacesTest, SoupsWithAttributes) {
    const FakeInput b = placed(makeSoup(3000, 1e-4, 1, 2, true), GetParam().scale, GetParam().offset);
    expectBothWays(makeSoup(20'000, 1e-4, 2, 1, true), b, 300);
}

TEST_P(InsertPlacesTest, SpheresStayClosed) {
    const FakeInput a = noisySphere(60);
    const FakeInput b = placed(noisySphere(30), GetParam().scale, GetParam().offset);
    expectBothWays(a, b, 500);
    const levels::CrackReport report = cracks("d");
    EXPECT_EQ(report.full.openEdges, 0u);
    EXPECT_EQ(report.openEdges, 0u);
    EXPECT_EQ(report.looseBoxes, 0u);
    EXPECT_GT(report.twoLevels + report.moreLevels, 2u);
    EXPECT_LE(worstError("d"), 1.0);
}

TEST_P(InsertPlacesTest, IntoLittle) {
    const FakeInput b = placed(noisySphere(30), GetParam().scale, GetParam().offset);
    expectBothWays(noisySphere(3), b, 500);
    expectBothWays(b, placed(noisySphere(3), 0.5, {0, 0, 0}), 500);
}

INSTANTIATE_TEST_SUITE_P(
    Places, InsertPlacesTest,
    testing::Values(InsertCase{"Inside", 0.1, {0.3, 0.2, -0.1}}, InsertCase{"Same", 1, {0, 0, 0}},
                    InsertCase{"Touching", 0.5, {1.4, 0, 0}}, InsertCase{"Beside", 1, {2.5, 0.1, -0.3}},
                    InsertCase{"Below", 0.7, {-3, -2, -5}}, InsertCase{"FarOut", 1, {-90, 40, 3}},
                    InsertCase{"Around", 30, {0, 0, 0}}),
    [](const auto& tested) { return tested.param.name; });

TEST_F(InsertTest, ManyTimes) {
    FakeInput all = noisySphere(40);
    build(all, "d", 500);
    for (int i = 0; i < 4; ++i) {
        const FakeInput more = placed(noisySphere(12), 0.3, {0.8 * std::cos(i), 0.8 * std::sin(i), 0.4 * i});
        insert(more, "d");
        expectGood("d");
        all = together(all, more);
    }
    expectAsBuilt("d", all, 500);
    EXPECT_EQ(cracks("d").openEdges, 0u);
    EXPECT_LE(worstError("d"), 1.0);
    EXPECT_EQ(load(path("d")).manifest.provenance.size(), 5u);
}

// What a model far away does not touch keeps its pages, byte for byte where they were.
TEST_F(InsertTest, PagesThatNothingTouchesStay) {
    FakeInput large;
    for (int i = 0; i < 40; ++i) {
        large = together(large, placed(noisySphere(14), 1, {2.5 * (i % 8), 2.5 * (i / 8), 0}));
    }
    build(large, "d", 500);
    const Loaded before = load(path("d"));
    insert(placed(noisySphere(10), 0.1, {0.5, 0.2, 1.1}), "d");
    expectGood("d");
    const Loaded after = load(path("d"));
    ASSERT_EQ(after.manifest.pageFiles.size(), 2u);
    EXPECT_EQ(after.manifest.pageFiles[0].name, "pages-1.bin");
    const auto old = [](const PageRecord& page) { return page.file == 0; };
    const auto kept = std::ranges::count_if(after.hierarchy.pages, old);
    EXPECT_GT(kept, std::ssize(before.hierarchy.pages) * 7 / 10);
    std::map<std::uint64_t, const PageRecord*> places;
    for (const PageRecord& page : before.hierarchy.pages) places[page.offset] = &page;
    for (const PageRecord& page : after.hierarchy.pages) {
        if (page.file != 0) continue;
        ASSERT_TRUE(places.contains(page.offset));
        EXPECT_EQ(places[page.offset]->bytes, page.bytes);
    }
    EXPECT_EQ(readWholeFile(path("d/pages-1.bin"), 1u << 30)->size(), before.manifest.pageFiles[0].bytes);
}

TEST_F(InsertTest, BytesDoNotDependOnThreadsOrMemory) {
    const FakeInput a = together(makeSoup(10'000, 1e-4, 2, 1, true), makeSoup(2000, 8, 12, 4, true));
    const FakeInput b = placed(makeSoup(3000, 1e-4, 2, 2, true), 1, {3, 1, 0});
    const auto bytesOf = [&](const std::string& name, const Chosen& chosen, BuildParts parts) {
        build(a, name, 300);
        insert(b, name, chosen, std::move(parts));
        std::string bytes;
        for (const char* file : {"dataset.json", "hierarchy-2.bin", "pages-2.bin"}) {
            bytes += readWholeFile(path(name + "/" + file), 1u << 30).value();
        }
        return bytes;
    };
    BuildParts little;
    little.batchTriangles = 500, little.chunkBytes = 4096;
    const std::string bytes = bytesOf("one", {.threads = 1}, {});
    EXPECT_TRUE(bytes == bytesOf("four", {.threads = 4}, {}));
    EXPECT_TRUE(bytes == bytesOf("little", {.memoryBytes = 64u << 20, .threads = 2}, std::move(little)));
}

// Into levels that were decided by whole cells and made in memory.
TEST_F(InsertTest, InHalvesOfCellsAndThroughTheFile) {
    const FakeInput a = together(makeSoup(10'000, 1e-4, 2, 1, true), makeSoup(2000, 8, 12, 4, true));
    const FakeInput b = placed(makeSoup(3000, 1e-4, 2, 2, true), 1, {3, 1, 0});
    build(a, "d", 300);
    BuildParts parts;
    parts.levels = {.chunkTriangles = 1, .cellTriangles = 500};
    insert(b, "d", {}, std::move(parts));
    expectAsBuilt("d", together(a, b), 300);
}

TEST_F(InsertTest, RootsThatPagesCannotSpan) {
    const FakeInput a = makeSoup(5000, 1e-4, 2, 1, true);
    build(a, "d", 200);
    ASSERT_FALSE(load(path("d")).manifest.levels.empty());
    FakeInput far = placed(makeSoup(100, 0.1, 2, 2, true), 1, {1e5, 0, 0});
    insert(far, "d");
    const Loaded grown = load(path("d"));
    EXPECT_GT(grown.hierarchy.rootCellLog2, 32u);
    EXPECT_FALSE(grown.manifest.levels.empty());
    FakeInput more = makeSoup(1000, 1e-3, 2, 3, true);
    insert(more, "d");
    expectAsBuilt("d", together(together(a, far), more), 200);
}

TEST_F(InsertTest, AttributesThatTheDatasetLacksAreDropped) {
    class Notes : public NoProgress {
      public:
        void note(const std::string& text) override { notes += text; }
        std::string notes;
    } progress;
    build(makeSoup(500, 0.1, 1, 1), "plain", 100);
    BuildOptions options;
    options.inputs = {"full.ply"};
    options.output = path("plain");
    const FakeInput full = makeSoup(300, 0.1, 1, 2, true);
    BuildParts parts;
    parts.openImporter = fakeImporters({{"full.ply", full}});
    ASSERT_TRUE(insertIntoDatasetFrom(options, progress, parts).ok());
    EXPECT_NE(progress.notes.find("full.ply: its colours are dropped"), std::string::npos) << progress.notes;
    EXPECT_NE(progress.notes.find("normals"), std::string::npos);
    EXPECT_FALSE(load(path("plain")).manifest.colors);
    // The other way round, what lacks attributes gets those of a build.
    build(full, "full", 100);
    insert(makeSoup(500, 0.1, 1, 1), "full");
    expectGood("full");
}

TEST_F(InsertTest, CompactKeepsAllButTheGarbage) {
    build(makeSoup(20'000, 1e-4, 2, 1, true), "d", 300);
    insert(makeSoup(5000, 1e-3, 2, 2, true), "d");
    insert(placed(makeSoup(500, 1e-3, 2, 3, true), 1, {6, 0, 0}), "d");
    const Loaded before = load(path("d"));
    EXPECT_GT(garbageBytes(before.manifest), 0u);
    NoProgress progress;
    const auto manifest = compactDataset(path("d"), progress);
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    expectGood("d");
    const Loaded after = load(path("d"));
    EXPECT_EQ(garbageBytes(after.manifest), 0u);
    EXPECT_EQ(after.manifest.levels, before.manifest.levels);
    EXPECT_EQ(after.manifest.full, before.manifest.full);
    EXPECT_EQ(directory_.list().size(), 4u);
    // Entries have the same pages, and these the same bytes.
    ASSERT_EQ(after.hierarchy.entries.size(), before.hierarchy.entries.size());
    for (std::size_t e = 0; e < after.hierarchy.entries.size(); ++e) {
        const LevelRecord &a = before.hierarchy.entries[e], &b = after.hierarchy.entries[e];
        ASSERT_EQ(a.pageCount, b.pageCount);
        for (std::uint32_t page = 0; page < a.pageCount; ++page) {
            EXPECT_TRUE(before.pages[a.firstPage + page] == after.pages[b.firstPage + page]);
            EXPECT_TRUE(before.morphs[a.firstPage + page] == after.morphs[b.firstPage + page]);
        }
    }
}

void expectError(const Result<Manifest>& result, const std::string& text) {
    ASSERT_FALSE(result.ok());
    EXPECT_NE(result.error().message.find(text), std::string::npos) << result.error().message;
    EXPECT_EQ(result.error().message.find('\n'), std::string::npos) << result.error().message;
}

// A limit on file sizes stands in for a full disk.
TEST_F(InsertTest, FullDisk) {
    build(makeSoup(5000, 1e-3, 1, 1), "d", 200);
    const auto files = directory_.list();
    const auto before = readTriangles(path("d"));
    FakeInput more = makeSoup(5000, 1e-3, 1, 2);
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
    for (const rlim_t bytes : {0, 1000, 20'000, 100'000}) {
        const rlimit small{bytes, limit.rlim_max};
        ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
        const auto result = insertInto(more, path("d"));
        NoProgress progress;
        const auto compacted = compactDataset(path("d"), progress);
        setrlimit(RLIMIT_FSIZE, &limit);
        expectError(result, "free some space");
        expectError(compacted, "free some space");
        EXPECT_EQ(directory_.list(), files) << bytes;
    }
    EXPECT_TRUE(readTriangles(path("d")) == before);
    more.failAfter = 3000;
    expectError(insertInto(more, path("d")), "broken");
    EXPECT_TRUE(readTriangles(path("d")) == before);
    expectGood("d");
}

TEST_F(InsertTest, DamageIsFound) {
    build(makeSoup(5000, 1e-3, 1, 1), "d", 200);
    std::string bytes = readWholeFile(path("d/pages-1.bin"), 1u << 30).value();
    for (std::size_t i = 0; i < bytes.size(); i += 500) bytes[i] ^= 1;
    directory_.write("d/pages-1.bin", bytes);
    const auto files = directory_.list();
    expectError(insertInto(makeSoup(500, 1e-3, 1, 2), path("d")),
                "d/pages-1.bin: page or morph block at byte");
    EXPECT_EQ(directory_.list(), files);
}

TEST_F(InsertTest, Refusals) {
    const FakeInput soup = makeSoup(300, 0.1, 1, 1);
    expectError(insertInto(soup, path("none")), "dataset.json");
    build(soup, "d", 100);
    const auto files = directory_.list();
    NoProgress progress;
    BuildOptions options;
    options.output = path("d");
    for (const char* input : {"d", "d/pages-1.bin", "d/../d/."}) {
        options.inputs = {path(input)};
        expectError(insertIntoDataset(options, progress), "is the dataset that is inserted into");
    }
    options.inputs = {path("missing.ply")};
    expectError(insertIntoDataset(options, progress), "missing.ply");
    options.inputs = {};
    expectError(insertIntoDataset(options, progress), "no inputs");
    FakeInput empty;
    empty.triangles = {makeTriangle({1, 1, 1}, {1, 1, 1}, {1, 1, 1})};
    expectError(insertInto(empty, path("d")), "nothing to insert");
    expectError(insertInto(placed(soup, 1, {1e15, 0, 0}), path("d")), "too far");
    EXPECT_EQ(directory_.list(), files);
    expectError(compactDataset(path("none"), progress), "dataset.json");
    EXPECT_EQ(directory_.list(), files);
}

}  // namespace
}  // namespace iwalk
