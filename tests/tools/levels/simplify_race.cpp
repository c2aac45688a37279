#include "tests/tools/levels/simplify_race.hpp"

#include <meshoptimizer.h>

#include <cmath>
#include <cstring>

#include "tests/tools/levels/level_triangles.hpp"

namespace iwalk::levels {
namespace {

// Halvings of the interval of their error bound: 1e-7 to 1 of the model's extent, to within 2 %.
constexpr int kBisections = 10;
constexpr double kLeastBound = 1e-7;

// The welded input.
struct IndexedMesh {
    std::vector<Corner> corners;
    std::vector<glm::vec3> positions;  // the same, relative to the middle of the grid: less than 2^-24 off
    std::vector<std::uint32_t> indices;
};

IndexedMesh weld(const std::vector<FixedTriangle>& triangles) {
    const std::size_t count = 3 * triangles.size();
    std::vector<std::uint32_t> remap(count);
    const std::size_t unique =
        meshopt_generateVertexRemap(remap.data(), nullptr, count, triangles.data(), count, sizeof(Corner));
    IndexedMesh mesh;
    mesh.corners.resize(unique);
    meshopt_remapVertexBuffer(mesh.corners.data(), triangles.data(), count, sizeof(Corner), remap.data());
    mesh.indices = std::move(remap);
    const double middle = std::ldexp(1.0, kGridLog2 - 1);
    for (const Corner& corner : mesh.corners)
        mesh.positions.emplace_back((toDouble(corner) - glm::dvec3(middle)) / middle);
    return mesh;
}

// `bound`: the error that meshoptimizer is allowed, relative to the model's extent. As it is a bound of its
// own quadrics, not of distances, the result is to be measured.
std::vector<FixedTriangle> simplify(const IndexedMesh& mesh, double bound) {
    std::vector<std::uint32_t> indices(mesh.indices.size());
    indices.resize(meshopt_simplify(indices.data(), mesh.indices.data(), mesh.indices.size(),
                                    &mesh.positions[0].x, mesh.positions.size(), sizeof(glm::vec3), 0,
                                    static_cast<float>(bound), 0, nullptr));
    std::vector<FixedTriangle> triangles(indices.size() / 3);
    for (std::size_t i = 0; i < indices.size(); ++i) triangles[i / 3][i % 3] = mesh.corners[indices[i]];
    return triangles;
}

// Their result with this bound, measured.
void tryBound(const IndexedMesh& mesh, const Reference& full, double error, double bound,
              SimplifyRace& race) {
    auto triangles = simplify(mesh, bound);
    race.theirTriangles = triangles.size();
    race.theirP999 = deviationOf(std::move(triangles), full, error).p999();
}

// Fills in their side: the coarsest that is as good as ours. `error`: the level's, in parts of the grid.
void race(const IndexedMesh& mesh, const Reference& full, double error, SimplifyRace& result) {
    tryBound(mesh, full, error, 1, result);
    result.stuck = result.theirP999 <= result.p999;
    if (result.stuck) return;
    tryBound(mesh, full, error, kLeastBound, result);
    double low = std::log(kLeastBound), high = 0;
    for (int i = 0; i < kBisections; ++i) {
        SimplifyRace attempt = result;
        const double middle = (low + high) / 2;
        tryBound(mesh, full, error, std::exp(middle), attempt);
        const bool good = attempt.theirP999 <= result.p999;
        (good ? low : high) = middle;
        if (good) result = attempt;
    }
}

}  // namespace

Result<std::vector<SimplifyRace>> raceSimplify(const DatasetPages& pages, const SampleOptions& options) {
    std::vector<SimplifyRace> report;
    const FixedGrid grid(pages.hierarchy());
    ASSIGN_OR_RETURN(auto input, levelTriangles(pages, grid, kFullLevel));
    if (input.empty()) return report;
    const IndexedMesh mesh = weld(input);
    const Reference full(std::move(input), options);
    for (unsigned level = 0; level < pages.manifest().levels.size(); ++level) {
        ASSIGN_OR_RETURN(auto triangles, levelTriangles(pages, grid, level));
        const double error = pages.manifest().levels[level].error / grid.unit(pages.manifest());
        SimplifyRace result{level, triangles.size(), 0, 0, 0, false};
        result.p999 = deviationOf(std::move(triangles), full, error).p999();
        race(mesh, full, error, result);
        report.push_back(result);
    }
    return report;
}

}  // namespace iwalk::levels
