#include "tests/preprocess/levels_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "preprocess/generate/generate.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk {
namespace {

// A cube's surface in n^2 squares a side, as integers in [0, n], so that what sides share is equal.
using CubePoint = glm::ivec3;

// Of a number in [0, 1) that belongs to the point.
double randomOf(const CubePoint& p) {
    std::seed_seq seed{p.x, p.y, p.z};
    return static_cast<double>(std::mt19937(seed)()) * 0x1p-32;
}

glm::dvec3 onSphere(const CubePoint& p, unsigned n, double bumps, double noise) {
    // Equal angles rather than equal lengths: triangles of nearly one size.
    const auto spread = [&](int i) {
        return std::tan((2.0 * i / static_cast<double>(n) - 1) * std::numbers::pi / 4);
    };
    const glm::dvec3 way = glm::normalize(glm::dvec3(spread(p.x), spread(p.y), spread(p.z)));
    const double bump = std::sin(9 * way.x + 1) * std::sin(7 * way.y + 2) * std::sin(8 * way.z + 3);
    return way * (1 + bumps * bump + noise * (2 * randomOf(p) - 1));
}

void addSquare(FakeInput& input, const std::array<glm::dvec3, 4>& corners) {
    const auto& [a, b, c, d] = corners;
    input.triangles.push_back(makeTriangle(a, b, c));
    input.triangles.push_back(makeTriangle(a, c, d));
}

FakeInput sphereModel() {
    return noisySphere(70);
}
FakeInput plantModel() {
    return plant(40'000);
}
FakeInput soupModel() {
    return makeSoup(40'000, 1e-4, 1, 9, true);
}
FakeInput fanModel() {
    return fan(20'000);
}
FakeInput oneModel() {
    return makeSoup(1, 0.1, 1, 1);
}
FakeInput twoModel() {
    return makeSoup(2, 0.1, 1, 2, true);
}
FakeInput twentyModel() {
    return makeSoup(20, 0.1, 1, 3);
}

}  // namespace

FakeInput noisySphere(unsigned n, double bumps, double noise) {
    FakeInput input;
    const int last = static_cast<int>(n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto at = [&](int i, int j, int side) {
            CubePoint p(0);
            p[axis] = side, p[(axis + 1) % 3] = i, p[(axis + 2) % 3] = j;
            return onSphere(p, n, bumps, noise);
        };
        for (int i = 0; i < last; ++i) {
            for (int j = 0; j < last; ++j) {
                addSquare(input, {at(i, j, 0), at(i, j + 1, 0), at(i + 1, j + 1, 0), at(i + 1, j, 0)});
                addSquare(input,
                          {at(i, j, last), at(i + 1, j, last), at(i + 1, j + 1, last), at(i, j + 1, last)});
            }
        }
    }
    return input;
}

FakeInput fan(unsigned count) {
    FakeInput input;
    const auto rib = [&](unsigned i) {
        const double angle = 2 * std::numbers::pi * (i % count) / count;
        return glm::dvec3(std::cos(angle), std::sin(angle), 0.2 * std::sin(7 * angle));
    };
    for (unsigned i = 0; i < count; ++i) {
        input.triangles.push_back(makeTriangle({0, 0, 0}, rib(i), rib(i + 1)));
    }
    return input;
}

FakeInput plant(std::uint64_t triangles) {
    const TempDirectory directory;
    NoProgress progress;
    const std::string path = directory.path("plant.ply");
    const auto generated = generateScene({"plant", triangles, 1, path}, progress);
    EXPECT_TRUE(generated.ok()) << generated.error().message;
    const auto importer = openImporter(path, {std::uint64_t{64} << 20, directory.path("")});
    EXPECT_TRUE(importer.ok()) << importer.error().message;
    const auto nothing = [](auto) {};
    const auto summary = (*importer)->scan(nothing, nothing);
    EXPECT_TRUE(summary.ok()) << summary.error().message;
    FakeInput input;
    input.colors = summary->colors, input.normals = summary->normals;
    input.precision = summary->precision;
    const auto keep = [&](std::span<const Triangle> batch) -> Result<void> {
        input.triangles.insert(input.triangles.end(), batch.begin(), batch.end());
        return {};
    };
    EXPECT_TRUE((*importer)->triangles(keep, nothing).ok());
    return input;
}

FakeInput duplicates() {
    FakeInput input;
    for (int copy = 0; copy < 3; ++copy) {
        for (const Triangle& triangle : noisySphere(8).triangles) input.triangles.push_back(triangle);
    }
    const Triangle same = makeTriangle({1, 1, 1}, {1.01, 1, 1}, {1, 1.01, 1});
    const Triangle turned{same[0], same[2], same[1]};
    for (int copy = 0; copy < 3000; ++copy) input.triangles.push_back(copy % 3 == 0 ? turned : same);
    return input;
}

FakeInput largeAmongSmall() {
    FakeInput input = makeSoup(20'000, 1e-4, 0.1, 6);
    input.triangles.push_back(makeTriangle({-4, -4, -4}, {4, 4, -4}, {-4, 4, 4}));
    return input;
}

std::vector<LevelModelCase> levelModels() {
    return {{"Sphere", sphereModel, 2000}, {"Plant", plantModel, 2000},     {"Soup", soupModel, 1000},
            {"Fan", fanModel, 500},        {"Duplicates", duplicates, 100}, {"Large", largeAmongSmall, 500},
            {"One", oneModel, 16},         {"Two", twoModel, 16},           {"Twenty", twentyModel, 16}};
}

}  // namespace iwalk
