#include "tests/tools/levels/simplify_race.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <future>

#include "tests/tools/levels/level_triangles.hpp"

namespace iwalk::levels {
namespace {

// Of their error bound, from one try to the next, and the least; relative to the model's extent.
constexpr double kFiner = 0.5, kLeastBound = 1e-7;
constexpr double kBeyond = 8;  // times the coarsest level's error: where to begin

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

// What a bound comes to.
struct Try {
    double bound = 0;
    std::uint64_t triangles = 0;
    double p999 = 0;  // in parts of the grid
};

// Tries from coarse to fine, each finer by kFiner, two at a time: from one that is worse than `coarsest` (or
// the coarsest that there is) to one that is as good as `finest`.
std::vector<Try> triesFor(const IndexedMesh& mesh, const Reference& full, double coarsest, double finest,
                          double bound) {
    const auto attempt = [&](double at) {
        auto triangles = simplify(mesh, at);
        const std::uint64_t count = triangles.size();
        return Try{at, count, deviationOf(std::move(triangles), full, 1).p999()};
    };
    std::vector<Try> tries{attempt(bound)};
    if (tries.front().p999 <= coarsest) {
        const Try most = attempt(1);
        if (most.p999 <= coarsest) tries.insert(tries.begin(), most);
        while (tries.front().p999 <= coarsest && tries.front().bound < 1)
            tries.insert(tries.begin(), attempt(std::min(1.0, tries.front().bound / kFiner)));
    }
    while (tries.back().p999 > finest && tries.back().bound > kLeastBound) {
        const double next = tries.back().bound * kFiner;
        auto other = std::async(std::launch::async, attempt, next * kFiner);
        tries.push_back(attempt(next));
        tries.push_back(other.get());
    }
    return tries;
}

// Fills in their side from the two tries around our error; between them logarithms are linear.
void race(const std::vector<Try>& tries, std::uint64_t all, double p999, SimplifyRace& result) {
    const auto good =
        std::find_if(tries.begin(), tries.end(), [&](const Try& one) { return one.p999 <= p999; });
    result.stuck = good == tries.begin();
    result.theirTriangles = good == tries.end() ? all : good->triangles;
    if (result.stuck || good == tries.end() || good->p999 <= 0) return;
    const Try& worse = *(good - 1);
    const double way = std::log(p999 / good->p999) / std::log(worse.p999 / good->p999);
    const double fewer =
        std::log(static_cast<double>(good->triangles) / static_cast<double>(worse.triangles));
    result.theirTriangles = static_cast<std::uint64_t>(
        std::llround(static_cast<double>(good->triangles) * std::exp(-way * fewer)));
}

}  // namespace

Result<std::vector<SimplifyRace>> raceSimplify(const DatasetPages& pages, const SampleOptions& options) {
    std::vector<SimplifyRace> report;
    const FixedGrid grid(pages.hierarchy());
    ASSIGN_OR_RETURN(auto input, levelTriangles(pages, grid, kFullLevel));
    if (input.empty()) return report;
    const IndexedMesh mesh = weld(input);
    const Reference full(std::move(input), options);
    std::vector<double> ours;  // in parts of the grid
    for (unsigned level = 0; level < pages.manifest().levels.size(); ++level) {
        ASSIGN_OR_RETURN(auto triangles, levelTriangles(pages, grid, level));
        const double error = pages.manifest().levels[level].error / grid.unit(pages.manifest());
        report.push_back({level, triangles.size(), 0, 0, false});
        ours.push_back(deviationOf(std::move(triangles), full, 1).p999());
        report.back().p999 = ours.back() / error;
    }
    if (report.empty()) return report;
    const double coarsest = pages.manifest().levels[0].error / grid.unit(pages.manifest());
    const double bound = std::min(1.0, kBeyond * std::ldexp(coarsest, -kGridLog2));
    const auto [least, most] = std::minmax_element(ours.begin(), ours.end());
    const std::vector<Try> tries = triesFor(mesh, full, *most, *least, bound);
    for (SimplifyRace& result : report) race(tries, mesh.indices.size() / 3, ours[result.level], result);
    return report;
}

}  // namespace iwalk::levels
