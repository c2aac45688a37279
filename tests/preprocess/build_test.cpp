#include "preprocess/build/build.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/dataset/hierarchy.hpp"
#include "common/file.hpp"
#include "preprocess/build/verify.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/soup.hpp"

namespace iwalk {
namespace {

std::string bytesIn(const std::string& dataset) {
    std::string bytes;
    for (const char* name : {"dataset.json", "hierarchy-1.bin", "pages-1.bin"}) {
        bytes += readWholeFile(dataset + "/" + name, 1u << 30).value();
    }
    return bytes;
}

// Builds, and expects that the dataset is good and has exactly the quantised input.
Manifest expectFaithful(const FakeInput& input, const std::string& output, const Chosen& chosen) {
    const auto manifest = buildFrom(input, output, chosen);
    EXPECT_TRUE(manifest.ok()) << manifest.error().message;
    if (!manifest) return {};
    const auto wanted = quantised(input.triangles, manifest->stepExponent, input.colors, input.normals);
    EXPECT_EQ(manifest->triangles, wanted.size());
    EXPECT_TRUE(readTriangles(output) == wanted);
    NoProgress progress;
    const auto verified = verifyDataset(output, progress);
    EXPECT_TRUE(verified.ok()) << verified.error().message;
    if (!verified) return *manifest;
    EXPECT_EQ(verified->problems, std::vector<std::string>{});
    return *manifest;
}

TEST(BuildTest, KeepsEveryTriangle) {
    const TempDirectory directory;
    const FakeInput soup = makeSoup(30'000, 1e-4, 0.1, 1);
    const Manifest manifest = expectFaithful(soup, directory.path("a"), {.leafTriangles = 200});
    EXPECT_GT(manifest.leaves, 100u);
    EXPECT_FALSE(manifest.colors);
    EXPECT_EQ(directory.list(),
              (std::vector<std::string>{"a", "a/dataset.json", "a/hierarchy-1.bin", "a/pages-1.bin"}));
}

TEST(BuildTest, KeepsAttributes) {
    const TempDirectory directory;
    const Manifest manifest =
        expectFaithful(makeSoup(20'000, 1e-4, 3, 2, true), directory.path("a"), {.leafTriangles = 1000});
    EXPECT_TRUE(manifest.colors);
    EXPECT_TRUE(manifest.normals);
}

TEST(BuildTest, TakesOneTriangle) {
    const TempDirectory directory;
    FakeInput input;
    input.triangles = {makeTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})};
    const Manifest manifest = expectFaithful(input, directory.path("a"), {});
    EXPECT_EQ(manifest.nodes, 1u);
    EXPECT_EQ(manifest.bounds, (ModelBox{{0, 0, 0}, {1, 1, 0}}));
}

// Larger than their neighbours' cells by far: they stay together at an ancestor, in several pages.
TEST(BuildTest, LargeTrianglesStayAtAncestors) {
    const TempDirectory directory;
    FakeInput input = makeSoup(50'000, 20, 30, 3);
    for (Triangle& triangle : input.triangles) {
        for (Corner& corner : triangle) corner.position += 100.0;
    }
    input.triangles.push_back(makeTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    const Manifest manifest = expectFaithful(input, directory.path("a"), {});
    const Hierarchy hierarchy = loadHierarchy(directory.path("a"), manifest).value();
    const NodeRecord& largest = *std::ranges::max_element(
        hierarchy.nodes, {}, [&](const NodeRecord& node) { return hierarchy.ownTriangles(node); });
    const LevelRecord& entry = *hierarchy.fullEntryOf(largest);
    EXPECT_GT(entry.triangles, 30'000u);
    EXPECT_GE(entry.pageCount, 2u);
    EXPECT_LE(largest.depth, 2);
}

TEST(BuildTest, DuplicatedCentroidsEnd) {
    const TempDirectory directory;
    FakeInput input = makeSoup(1000, 1e-3, 1, 4);
    const Triangle tiny = makeTriangle({0.5, 0.5, 0.5}, {0.5 + 0x1p-20, 0.5, 0.5}, {0.5, 0.5 + 0x1p-20, 0.5});
    input.triangles.insert(input.triangles.end(), 40'000, tiny);
    expectFaithful(input, directory.path("a"), {.leafTriangles = 100});
}

TEST(BuildTest, StrayVerticesDoNotCoarsenTheStep) {
    const TempDirectory directory;
    FakeInput input = makeSoup(20'000, 1e-4, 0.1, 5);
    input.triangles.push_back(makeTriangle({9000, 0, 0}, {9001, 0, 0}, {9000, 1, 0}));
    const Manifest manifest = expectFaithful(input, directory.path("a"), {.leafTriangles = 500});
    EXPECT_EQ(manifest.stepExponent, 2 - 24);
}

// Wide records (root cell above 2^32 steps) and wide pages.
TEST(BuildTest, ReachesFar) {
    const TempDirectory directory;
    FakeInput input = makeSoup(5000, 1e-4, 10, 6, true);
    const double far = std::ldexp(1.0, 39 - 22);
    input.triangles.push_back(makeTriangle({far, -far, far}, {far + 30, -far, far}, {far, -far + 30, far}));
    input.triangles.back()[1].normal = input.triangles.back()[0].normal = {0, 0, 1};
    input.triangles.back()[2].normal = {0, 1, 0};
    expectFaithful(input, directory.path("a"), {.leafTriangles = 100, .stepExponent = -22});
}

TEST(BuildTest, StepCanBeChosen) {
    const TempDirectory directory;
    const FakeInput soup = makeSoup(3000, 0.01, 0.1, 7);
    EXPECT_EQ(expectFaithful(soup, directory.path("a"), {.stepExponent = -8}).stepExponent, -8);
}

TEST(BuildTest, DropsAndCountsDegenerates) {
    const TempDirectory directory;
    FakeInput input;
    input.triangles = {makeTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                       makeTriangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0}),     // a line with three points: kept
                       makeTriangle({0, 0, 0}, {0.01, 0, 0}, {0, 1, 0}),  // two corners meet on the lattice
                       makeTriangle({0, 0, 0}, {0, 0, 0}, {0, 0, 0})};
    const Manifest manifest = expectFaithful(input, directory.path("a"), {.stepExponent = 0});
    EXPECT_EQ(manifest.triangles, 2u);
    EXPECT_EQ(manifest.provenance.at(0).droppedDegenerate, 2u);
    EXPECT_EQ(manifest.provenance.at(0).triangles, 2u);
}

// Attributes of inputs that lack what others have: light grey, and the face's normal.
TEST(BuildTest, JoinsInputs) {
    const TempDirectory directory;
    NoProgress progress;
    const FakeInput full = makeSoup(100, 0.1, 0.2, 8, true);
    FakeInput plain;
    plain.triangles = {makeTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})};
    BuildParts parts;
    parts.openImporter = fakeImporters({{"dir/full.ply", full}, {"plain.ply", plain}});
    BuildOptions options;
    options.inputs = {"dir/full.ply", "plain.ply"};
    options.output = directory.path("a");
    const auto manifest = buildDatasetFrom(options, progress, parts);
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    EXPECT_EQ(manifest->provenance.at(0).input, "full.ply");
    EXPECT_EQ(manifest->provenance.at(1).triangles, 1u);

    std::vector<Triangle> all = full.triangles;
    all.push_back(plain.triangles[0]);
    for (Corner& corner : all.back()) corner.color = 0xffc8c8c8, corner.normal = {0, 0, 1};
    EXPECT_TRUE(readTriangles(directory.path("a")) == quantised(all, manifest->stepExponent, true, true));
}

// More inputs than memory has room for at once: they are opened twice, and nothing else changes.
TEST(BuildTest, ManyInputsInLittleMemory) {
    const TempDirectory directory;
    NoProgress progress;
    std::vector<std::pair<std::string, FakeInput>> inputs;
    BuildOptions options;
    std::vector<Triangle> all;
    for (unsigned i = 0; i < 12; ++i) {
        inputs.emplace_back("input" + std::to_string(i), makeSoup(50, 0.1, 0.2, i));
        options.inputs.push_back(inputs.back().first);
        all.insert(all.end(), inputs.back().second.triangles.begin(), inputs.back().second.triangles.end());
    }
    BuildParts parts;
    parts.openImporter = fakeImporters(inputs);
    for (const std::uint64_t mebibytes : {64, 512}) {
        options.memoryBytes = mebibytes << 20;
        options.output = directory.path(std::to_string(mebibytes));
        const auto manifest = buildDatasetFrom(options, progress, parts);
        ASSERT_TRUE(manifest.ok()) << manifest.error().message;
        EXPECT_TRUE(readTriangles(options.output) == quantised(all, manifest->stepExponent, false, false));
    }
    EXPECT_EQ(bytesIn(directory.path("64")), bytesIn(directory.path("512")));
}

// Small and large triangles, a crowd in one cell, one crowd of large ones, and one that nothing tells apart:
// together they make every part too large for a small batch.
FakeInput makeTroublesome() {
    FakeInput input = makeSoup(60'000, 1e-4, 1, 9, true);
    const FakeInput large = makeSoup(30'000, 8, 12, 10, true);
    FakeInput crowd = makeSoup(30'000, 1e-6, 1e-5, 11, true);
    for (Triangle& triangle : crowd.triangles) {
        for (Corner& corner : triangle) corner.position = corner.position * 1e-3 + glm::dvec3(1, 1, 1);
    }
    for (const FakeInput& more : {large, crowd}) {
        input.triangles.insert(input.triangles.end(), more.triangles.begin(), more.triangles.end());
    }
    Triangle same = input.triangles[0];
    for (unsigned i = 0; i < 20'000; ++i) {  // in colour only
        same[0].color = i;
        input.triangles.push_back(same);
    }
    return input;
}

TEST(BuildTest, BytesDoNotDependOnThreads) {
    const TempDirectory directory;
    const FakeInput input = makeTroublesome();
    for (const unsigned threads : {1u, 2u, 4u}) {
        const std::string output = directory.path(std::to_string(threads));
        ASSERT_TRUE(buildFrom(input, output, {.leafTriangles = 500, .threads = threads}).ok());
    }
    EXPECT_EQ(bytesIn(directory.path("1")), bytesIn(directory.path("2")));
    EXPECT_EQ(bytesIn(directory.path("1")), bytesIn(directory.path("4")));
}

TEST(BuildTest, BytesDoNotDependOnMemory) {
    const TempDirectory directory;
    const FakeInput input = makeTroublesome();
    expectFaithful(input, directory.path("much"), {.leafTriangles = 500});
    const auto little = [&](std::size_t batchTriangles, std::size_t chunkBytes) {
        const std::string output = directory.path(std::to_string(batchTriangles));
        BuildParts parts;
        parts.batchTriangles = batchTriangles;
        parts.chunkBytes = chunkBytes;
        const auto manifest = buildFrom(input, output, {.leafTriangles = 500}, parts);
        ASSERT_TRUE(manifest.ok()) << manifest.error().message;
        EXPECT_TRUE(bytesIn(output) == bytesIn(directory.path("much"))) << batchTriangles;
    };
    little(500, 2048);
    little(3001, 4096);
    little(25'000, 65536);
}

TEST(BuildTest, BytesDoNotDependOnTheMemoryLimit) {
    const TempDirectory directory;
    const FakeInput input = makeTroublesome();
    ASSERT_TRUE(
        buildFrom(input, directory.path("64"), {.memoryBytes = 64u << 20, .leafTriangles = 500}).ok());
    ASSERT_TRUE(
        buildFrom(input, directory.path("512"), {.memoryBytes = 512u << 20, .leafTriangles = 500}).ok());
    EXPECT_TRUE(bytesIn(directory.path("64")) == bytesIn(directory.path("512")));
}

}  // namespace
}  // namespace iwalk
