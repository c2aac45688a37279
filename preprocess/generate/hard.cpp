#include "preprocess/generate/hard.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "preprocess/generate/gradient_noise.hpp"
#include "preprocess/generate/grid_surface.hpp"
#include "preprocess/generate/random.hpp"
#include "preprocess/generate/trigonometry.hpp"

namespace iwalk {
namespace {

constexpr std::array<std::string_view, 6> kNames{"hard-far",  "hard-slivers", "hard-point",
                                                 "hard-flat", "hard-outlier", "hard-huge"};
constexpr float kSide = 10;  // of a grid, model units

// Waves over the unit square, some cells long.
float waves(float x, float y, std::uint32_t seed) {
    return gradientNoise(glm::vec3(x * 5, y * 5, 0.3f), seed) +
           0.2f * gradientNoise(glm::vec3(x * 31, y * 31, 0.7f), seed + 1);
}

struct Place {
    float x, y;  // 0..1
};
Place placeOf(const CellGrid& grid, std::uint32_t column, std::uint32_t row) {
    return {static_cast<float>(column) / static_cast<float>(grid.columns),
            static_cast<float>(row) / static_cast<float>(grid.rows)};
}

Result<void> far(const CellGrid& grid, std::uint32_t seed, PlyOutput& output, Progress& progress) {
    constexpr double kDistance = 1e7, kCell = 0.001;  // metres
    RETURN_IF_ERROR(writeGridVertices(grid, output, progress, [&](std::uint32_t column, std::uint32_t row) {
        const auto [x, y] = placeOf(grid, column, row);
        const double height = 20 * kCell * static_cast<double>(waves(x, y, seed));
        output.vertex(glm::dvec3(kDistance + column * kCell, kDistance + row * kCell, kDistance + height));
    }));
    return writeGridTriangles(grid, output, progress);
}

void writeWaves(const CellGrid& grid, std::uint32_t seed, std::uint32_t column, std::uint32_t row,
                PlyOutput& output) {
    const auto [x, y] = placeOf(grid, column, row);
    output.vertex(glm::vec3(kSide * x, kSide * y, waves(x, y, seed)));
}

Result<void> flat(const CellGrid& grid, std::uint64_t seed, PlyOutput& output, Progress& progress) {
    RETURN_IF_ERROR(writeGridVertices(grid, output, progress, [&](std::uint32_t column, std::uint32_t row) {
        Random random(seedOf(seed, column, row));
        const bool inside = column > 0 && row > 0 && column < grid.columns && row < grid.rows;
        const double dx = inside ? random.between(-0.2, 0.2) : 0, dy = inside ? random.between(-0.2, 0.2) : 0;
        output.vertex(glm::vec3(static_cast<float>(kSide * (column + dx) / grid.columns),
                                static_cast<float>(kSide * (row + dy) / grid.rows), 1));
    }));
    return writeGridTriangles(grid, output, progress);
}

// An ordinary surface with one triangle more: the last corner of it lies where `corners` says.
Result<void> withOne(const CellGrid& grid, std::uint32_t seed, const std::array<glm::vec3, 3>& corners,
                     PlyOutput& output, Progress& progress) {
    for (const glm::vec3& corner : corners) output.vertex(corner);
    RETURN_IF_ERROR(writeGridVertices(grid, output, progress, [&](std::uint32_t column, std::uint32_t row) {
        writeWaves(grid, seed, column, row, output);
    }));
    output.triangle(0, 1, 2);
    return writeGridTriangles(grid, output, progress, 3);
}

// A disc with waves whose triangles all reach its middle.
Result<void> point(std::uint32_t triangles, std::uint32_t seed, PlyOutput& output, Progress& progress) {
    progress.phase("vertices");
    output.vertex(glm::vec3(0));
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const double turn = static_cast<double>(i) / triangles;
        const glm::dvec2 at = onCircle(turn);
        const double radius =
            static_cast<double>(kSide) *
            (0.75 + 0.25 * static_cast<double>(gradientNoise(glm::vec3(glm::vec2(at) * 9.0f, 0.5f), seed)));
        const float z = gradientNoise(glm::vec3(glm::vec2(at) * 3.0f, 1.5f), seed);
        output.vertex(glm::vec3(glm::vec2(at * radius), z));
        if (i % 4096 == 0) RETURN_IF_ERROR(output.status());
    }
    progress.phase("triangles");
    for (std::uint32_t i = 0; i < triangles; ++i) output.triangle(0, 1 + i, 1 + (i + 1) % triangles);
    return output.status();
}

// Where one of the slivers' groups of four begins, which way it goes, and a way across.
struct Needle {
    glm::dvec3 begin, along, across;
};
Needle needleOf(std::uint64_t seed, std::uint32_t group) {
    Random random(seedOf(seed, group));
    glm::dvec3 begin(0), along(0);
    for (std::size_t axis = 0; axis < 3; ++axis) begin[axis] = random.between(0, static_cast<double>(kSide));
    for (std::size_t axis = 0; axis < 3; ++axis) along[axis] = random.between(-0.5, 0.5);
    return {begin, along, glm::dvec3(-along.y, along.x, 0)};
}

// Groups of five triangles of six vertices: a needle, the same once more, one without area, and two that lie
// partly upon one another.
Result<void> slivers(std::uint32_t groups, std::uint64_t seed, PlyOutput& output, Progress& progress) {
    constexpr double kThin = 1e-6;
    progress.phase("vertices");
    for (std::uint32_t group = 0; group < groups; ++group) {
        const auto [begin, along, across] = needleOf(seed, group);
        output.vertex(begin);
        output.vertex(begin + along);
        output.vertex(begin + along * 0.5 + across * kThin);
        output.vertex(begin + along * 0.5);
        output.vertex(begin + across * 0.1);
        output.vertex(begin + along * 0.05);
        if (group % 4096 == 0) RETURN_IF_ERROR(output.status());
        progress.done(static_cast<double>(group) / groups);
    }
    progress.phase("triangles");
    for (std::uint32_t group = 0; group < groups; ++group) {
        const std::uint32_t first = 6 * group;
        output.triangle(first, first + 1, first + 2);      // 1,000,000 : 1
        output.triangle(first + 1, first + 2, first);      // the same
        output.triangle(first, first + 3, first + 1);      // no area
        output.triangle(first, first + 3, first + 4);      // 5 : 1
        output.triangle(first + 5, first + 4, first + 3);  // upon a part of it, the other way round
        if (group % 4096 == 0) RETURN_IF_ERROR(output.status());
        progress.done(static_cast<double>(group) / groups);
    }
    return {};
}

}  // namespace

bool isHardScene(std::string_view name) {
    return std::ranges::find(kNames, name) != kNames.end();
}

VertexLayout hardLayout(std::string_view name) {
    return {.doubles = name == "hard-far" || name == "hard-slivers"};
}

Result<void> generateHard(std::string_view name, std::uint64_t triangles, std::uint64_t seed,
                          PlyOutput& output, Progress& progress) {
    const CellGrid grid = CellGrid::ofTriangles(triangles);
    const auto noise = static_cast<std::uint32_t>(seedOf(seed, 0));
    if (name == "hard-far") return far(grid, noise, output, progress);
    if (name == "hard-slivers")
        return slivers(static_cast<std::uint32_t>(triangles / 5), seed, output, progress);
    if (name == "hard-point") return point(static_cast<std::uint32_t>(triangles), noise, output, progress);
    if (name == "hard-flat") return flat(grid, seed, output, progress);
    if (name == "hard-outlier") {
        constexpr float kFar = kSide * 1e6f;
        return withOne(grid, noise, {glm::vec3(0), glm::vec3(kSide, 0, 0), glm::vec3(kFar, kFar, kFar)},
                       output, progress);
    }
    return withOne(grid, noise, {glm::vec3(0, 0, -3), glm::vec3(kSide, 0, 3), glm::vec3(0, kSide, 3)}, output,
                   progress);
}

}  // namespace iwalk
