// Vertices far from all others: the rest stays as exact as without them, and has its levels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "common/dataset/hierarchy.hpp"
#include "common/file.hpp"
#include "preprocess/build/split.hpp"
#include "preprocess/build/survey.hpp"
#include "preprocess/build/verify.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/soup.hpp"

namespace iwalk {
namespace {

const Triangle kSpike = makeTriangle({0.5, 0, 0}, {0, 0.5, 0}, {3e6, 2e6, -1e6});

FakeInput ordinary() {
    return makeSoup(20'000, 1e-4, 0.1, 5);
}

glm::dvec3 corner(const StoredTriangle& triangle, std::size_t c) {
    return {static_cast<double>(triangle[5 * c]), static_cast<double>(triangle[5 * c + 1]),
            static_cast<double>(triangle[5 * c + 2])};
}
glm::dvec3 areaOf(const StoredTriangle& t) {
    return glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)) / 2.0;
}

// What the dataset has beside these triangles, all of which it must have.
std::vector<StoredTriangle> others(const std::string& dataset, const std::vector<Triangle>& triangles,
                                   int stepExponent) {
    const auto all = readTriangles(dataset), known = quantised(triangles, stepExponent, false, false);
    EXPECT_TRUE(std::ranges::includes(all, known));
    std::vector<StoredTriangle> rest;
    std::ranges::set_difference(all, known, std::back_inserter(rest));
    return rest;
}

void expectGood(const std::string& dataset) {
    NoProgress progress;
    const auto verified = verifyDataset(dataset, progress);
    ASSERT_TRUE(verified.ok()) << verified.error().message;
    EXPECT_EQ(verified->problems, std::vector<std::string>{});
    const Manifest manifest = loadManifest(dataset).value();
    const Hierarchy hierarchy = loadHierarchy(dataset, manifest).value();
    EXPECT_GT(hierarchy.rootCellLog2, kMostWholeLog2);
    EXPECT_TRUE(hierarchy.hasLevels());
    EXPECT_LT(manifest.levels.front().triangles, manifest.triangles / 5);
}

// Together they are the triangle, as far as it lies within reach: without gaps and none twice, by their
// areas.
void expectPieces(const std::vector<StoredTriangle>& pieces, const Triangle& whole, const glm::dvec3& middle,
                  int stepExponent, bool isCut) {
    Triangle inSteps = whole;
    for (Corner& c : inSteps) c.position *= std::ldexp(1.0, -stepExponent);
    const glm::dvec3 a = inSteps[0].position;
    const glm::dvec3 cross = glm::cross(inSteps[1].position - a, inSteps[2].position - a);
    const glm::dvec3 normal = glm::normalize(cross);
    double area = 0;
    for (const StoredTriangle& piece : pieces) {
        area += glm::dot(areaOf(piece), normal);
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_LE(std::abs(glm::dot(corner(piece, c) - a, normal)), 1);
            if (!isCut) continue;
            for (std::size_t axis = 0; axis < 3; ++axis)
                EXPECT_LE(std::abs(corner(piece, c)[axis] - middle[axis]), kReach + 1);
        }
    }
    if (isCut) {
        // The spike has one corner far out: what is missing is the tip, similar to the whole but for the
        // step.
        double reached = 0;
        for (const StoredTriangle& piece : pieces) {
            for (std::size_t c = 0; c < 3; ++c) reached = std::max(reached, corner(piece, c).x - middle.x);
        }
        EXPECT_NEAR(reached, kReach, 1);
        const auto left = [&](std::size_t c) {
            return 1 - (middle.x + kReach - inSteps[c].position.x) /
                           (inSteps[2].position.x - inSteps[c].position.x);
        };
        EXPECT_NEAR(area / (glm::length(cross) / 2 * (1 - left(0) * left(1))), 1, 1e-6);
    } else {
        EXPECT_NEAR(area / (glm::length(cross) / 2), 1, 1e-6);
    }
}

std::string bytesIn(const std::string& dataset) {
    std::string bytes;
    for (const char* name : {"dataset.json", "hierarchy-1.bin", "pages-1.bin"})
        bytes += readWholeFile(dataset + "/" + name, 1u << 30).value();
    return bytes;
}

int spareDigits(int near, int far, double distance) {
    Distances distances;
    for (int i = 0; i < near; ++i) distances.add(std::vector{glm::dvec3(0.1, -1.5, 1)});
    for (int i = 0; i < far; ++i) distances.add(std::vector{glm::dvec3(0, 1, -distance)});
    return distances.spareDigits();
}

TEST(OutlierTest, AFewFarOutAreStrays) {
    EXPECT_EQ(spareDigits(190, 10, 0x1p8), 8);
    EXPECT_EQ(spareDigits(190, 10, 0x1.8p30), 30);
    EXPECT_EQ(spareDigits(190, 10, 0x1.fp7), 0);  // only large
    EXPECT_EQ(spareDigits(190, 11, 0x1p8), 0);    // too many
    EXPECT_EQ(spareDigits(0, 3, 0x1p8), 0);
    EXPECT_EQ(spareDigits(0, 0, 1), 0);
}

TEST(OutlierTest, TheRestIsAsWithoutIt) {
    const TempDirectory directory;
    FakeInput input = ordinary();
    const auto without = buildFrom(input, directory.path("without"), {.leafTriangles = 500});
    const std::vector<Triangle> rest = input.triangles;
    input.triangles.push_back(kSpike);
    // As of floats that reach so far.
    input.precision = 0.25;
    const auto manifest = buildFrom(input, directory.path("a"), {.leafTriangles = 500});
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    EXPECT_EQ(manifest->stepExponent, without->stepExponent);
    EXPECT_EQ(manifest->provenance.at(0).split, 1u);
    EXPECT_EQ(manifest->provenance.at(0).cut, 1u);
    EXPECT_EQ(loadManifest(directory.path("a"))->provenance.at(0).cut, 1u);
    expectGood(directory.path("a"));
    const auto pieces = others(directory.path("a"), rest, manifest->stepExponent);
    EXPECT_LT(pieces.size(), 100u);
    const double steps = std::ldexp(1.0, -manifest->stepExponent);
    // The middle lies near the origin, by what the soup's positions happen to be.
    double reached = 0;
    for (const StoredTriangle& piece : pieces) {
        for (std::size_t c = 0; c < 3; ++c) reached = std::max(reached, corner(piece, c).x);
    }
    const glm::dvec3 middle(reached - kReach, 0, 0);
    EXPECT_LT(std::abs(middle.x), 0.1 * steps);
    expectPieces(pieces, kSpike, middle, manifest->stepExponent, true);
}

TEST(OutlierTest, MemoryAndThreadsChangeNothing) {
    const TempDirectory directory;
    FakeInput input = ordinary();
    input.triangles.push_back(kSpike);
    BuildParts small;
    small.batchTriangles = 1000;
    small.chunkBytes = 4096;
    ASSERT_TRUE(buildFrom(input, directory.path("a"), {.leafTriangles = 500, .threads = 1}, small).ok());
    ASSERT_TRUE(buildFrom(input, directory.path("b"), {.leafTriangles = 500, .threads = 3}).ok());
    EXPECT_TRUE(bytesIn(directory.path("a")) == bytesIn(directory.path("b")));
}

// Too long for a page, where nodes are as small as the others need, but not for a lattice.
TEST(OutlierTest, LongOnesAreSplitAndAllThere) {
    const TempDirectory directory;
    FakeInput input = ordinary();
    const double far = std::ldexp(1.0, 40 - 22), side = std::ldexp(1.0, 30 - 22);
    input.triangles.push_back(makeTriangle({far, far, 0}, {far, far, 1}, {far, far + 1, 0}));
    const std::vector<Triangle> rest = input.triangles;
    const Triangle ground = makeTriangle({-side, -side, 1}, {side, -side, 1}, {0, side * 0.9, -1});
    input.triangles.push_back(ground);
    const auto manifest = buildFrom(input, directory.path("a"), {.leafTriangles = 500, .stepExponent = -22});
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    EXPECT_EQ(manifest->provenance.at(0).split, 1u);
    EXPECT_EQ(manifest->provenance.at(0).cut, 0u);
    expectGood(directory.path("a"));
    const auto pieces = others(directory.path("a"), rest, -22);
    EXPECT_GT(pieces.size(), 50u);
    expectPieces(pieces, ground, {}, -22, false);
}

// A part of the model that lies as far away, and is no triangle between: all of it stays.
TEST(OutlierTest, PartsFarApartAreKept) {
    const TempDirectory directory;
    FakeInput input = ordinary();
    FakeInput other = makeSoup(600, 1e-3, 0.1, 6);
    for (Triangle& triangle : other.triangles) {
        for (Corner& c : triangle) c.position += glm::dvec3(0x1p20, -0x1p19, 77);
        input.triangles.push_back(triangle);
    }
    const auto manifest = buildFrom(input, directory.path("a"), {.leafTriangles = 500});
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    expectGood(directory.path("a"));
    EXPECT_TRUE(others(directory.path("a"), input.triangles, manifest->stepExponent).empty());
    EXPECT_EQ(manifest->triangles, input.triangles.size());
}

TEST(OutlierTest, CanBeInserted) {
    const TempDirectory directory;
    FakeInput input = ordinary(), more;
    more.triangles = {kSpike};
    const auto before = buildFrom(input, directory.path("a"), {.leafTriangles = 500});
    ASSERT_TRUE(before.ok());
    NoProgress progress;
    BuildOptions options;
    options.inputs = {"more.ply"};
    options.output = directory.path("a");
    BuildParts parts;
    parts.openImporter = fakeImporters({{"more.ply", more}});
    const auto manifest = insertIntoDatasetFrom(options, progress, parts);
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    expectGood(directory.path("a"));
    EXPECT_EQ(manifest->provenance.at(1).cut, 1u);
    const auto pieces = others(directory.path("a"), input.triangles, manifest->stepExponent);
    EXPECT_EQ(pieces.size(), manifest->provenance.at(1).triangles);
    EXPECT_LT(pieces.size(), 100u);

    // And once more, into what reaches far already: an ordinary part, and what lies farther yet.
    FakeInput third = makeSoup(2000, 1e-3, 0.1, 8);
    third.triangles.push_back(makeTriangle({0, 0, 0x1p24}, {0, 1, 0x1p24}, {1, 0, 0x1p24}));
    options.inputs = {"third.ply"};
    parts.openImporter = fakeImporters({{"third.ply", third}});
    ASSERT_TRUE(insertIntoDatasetFrom(options, progress, parts).ok());
    expectGood(directory.path("a"));
    std::vector<Triangle> all = input.triangles;
    all.insert(all.end(), third.triangles.begin(), third.triangles.end());
    EXPECT_EQ(others(directory.path("a"), all, manifest->stepExponent), pieces);
}

// Where entries of the old dataset would be too large to stay.
TEST(OutlierTest, CannotBeInsertedIntoWhatReachesTooFar) {
    const TempDirectory directory;
    FakeInput input = ordinary(), more;
    input.triangles.push_back(makeTriangle({60, 0, 0}, {61, 0, 0}, {60, 1, 0}));
    more.triangles = {kSpike};
    ASSERT_TRUE(buildFrom(input, directory.path("a"), {.leafTriangles = 500, .stepExponent = -23}).ok());
    NoProgress progress;
    BuildOptions options;
    options.inputs = {"more.ply"};
    options.output = directory.path("a");
    BuildParts parts;
    parts.openImporter = fakeImporters({{"more.ply", more}});
    const auto result = insertIntoDatasetFrom(options, progress, parts);
    ASSERT_FALSE(result.ok());
    EXPECT_NE(result.error().message.find("build another dataset"), std::string::npos);
}

}  // namespace
}  // namespace iwalk
