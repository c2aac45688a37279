// What builds with levels write depends on the input alone, and is right by what `verify` knows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "common/dataset/hierarchy.hpp"
#include "common/file.hpp"
#include "preprocess/build/verify.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/levels_models.hpp"

namespace iwalk {
namespace {

class LevelBytesTest : public testing::TestWithParam<LevelModelCase> {
  protected:
    // A dataset in a directory of its own, so that generation is 1 in each.
    std::string build(const std::string& name, std::uint64_t mebibytes, unsigned threads,
                      BuildParts parts = {}) {
        const std::string output = directory_.path(name);
        const Chosen chosen{mebibytes << 20, GetParam().leafTriangles, std::nullopt, threads};
        const auto manifest = buildFrom(input_, output, chosen, std::move(parts));
        EXPECT_TRUE(manifest.ok()) << manifest.error().message;
        return output;
    }

    static std::string bytesOf(const std::string& dataset, const char* file) {
        const auto bytes = readWholeFile(dataset + "/" + file, 1u << 30);
        return bytes ? *bytes : bytes.error().message;
    }
    static void expectSame(const std::string& a, const std::string& b) {
        for (const char* file : {"dataset.json", "hierarchy-1.bin", "pages-1.bin"}) {
            EXPECT_TRUE(bytesOf(a, file) == bytesOf(b, file)) << file << " of " << a << " and " << b;
        }
    }

    TempDirectory directory_;
    FakeInput input_ = GetParam().make();
};

TEST_P(LevelBytesTest, DoNotDependOnThreadsOrMemory) {
    const std::string first = build("one-thread", 512, 1);
    expectSame(first, build("two-threads", 512, 2));
    expectSame(first, build("five-threads", 512, 5));
    expectSame(first, build("less-memory", 128, 2));
    expectSame(first, build("least-memory", 64, 5));
}

TEST_P(LevelBytesTest, DoNotDependOnBatches) {
    const std::string first = build("as-usual", 512, 2);
    BuildParts parts;
    parts.batchTriangles = GetParam().leafTriangles;
    parts.chunkBytes = 2048;
    expectSame(first, build("tiny-batches", 64, 2, parts));
    parts.batchTriangles = 3001;
    parts.chunkBytes = 4096;
    expectSame(first, build("small-batches", 64, 1, parts));
}

// Through a temporary file, every one of them: all but the places in the file is the same.
TEST_P(LevelBytesTest, LargeEntriesAreLikeOthers) {
    const std::string usual = build("usual", 512, 2);
    BuildParts parts;
    parts.levels.chunkTriangles = 1;
    const std::string large = build("large", 512, 2, parts);
    const Hierarchy a = loadHierarchy(usual, loadManifest(usual).value()).value();
    const Hierarchy b = loadHierarchy(large, loadManifest(large).value()).value();
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
    };
    EXPECT_TRUE(same(a.nodes, b.nodes));
    EXPECT_TRUE(same(a.entries, b.entries));
    ASSERT_EQ(a.pages.size(), b.pages.size());
    const std::string inA = bytesOf(usual, "pages-1.bin"), inB = bytesOf(large, "pages-1.bin");
    for (std::size_t i = 0; i < a.pages.size(); ++i) {
        const PageRecord &x = a.pages[i], &y = b.pages[i];
        EXPECT_EQ(inA.substr(x.offset, x.bytes), inB.substr(y.offset, y.bytes)) << i;
        EXPECT_EQ(inA.substr(x.morphOffset, x.morphBytes), inB.substr(y.morphOffset, y.morphBytes)) << i;
    }
}

TEST_P(LevelBytesTest, VerifyFindsNothing) {
    const std::string dataset = build("dataset", 512, 0);
    NoProgress progress;
    const auto verified = verifyDataset(dataset, progress);
    ASSERT_TRUE(verified.ok()) << verified.error().message;
    EXPECT_EQ(verified->problems, std::vector<std::string>{});
}

TEST_P(LevelBytesTest, LevelsGetNoLargerTowardsZero) {
    const auto manifest = loadManifest(build("dataset", 512, 0));
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    const auto& levels = manifest->levels;
    EXPECT_TRUE(std::ranges::is_sorted(levels, {}, &LevelSummary::triangles));
    EXPECT_TRUE(std::ranges::is_sorted(levels, std::greater(), &LevelSummary::error));
    EXPECT_EQ(manifest->full.triangles, manifest->triangles);
    for (const LevelSummary& level : levels) {
        EXPECT_LE(level.triangles, manifest->triangles);
        EXPECT_GT(level.triangles, 0u);
    }
}

INSTANTIATE_TEST_SUITE_P(Models, LevelBytesTest, testing::ValuesIn(levelModels()),
                         [](const auto& model) { return model.param.name; });

}  // namespace
}  // namespace iwalk
