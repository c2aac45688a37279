#include "tests/tools/triangle_set.hpp"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

namespace iwalk::tools {
namespace {

constexpr double kCellsAlongModel = 1 << 20;  // at most

// The same whichever corner comes first.
glm::dvec3 leastCorner(const Triangle& t) {
    return glm::min(t[0], glm::min(t[1], t[2]));
}

// Between corners that belong together in the best of the three ways to turn one triangle.
double distanceBetween(const Triangle& a, const Triangle& b) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t turn = 0; turn < 3; ++turn) {
        double worst = 0;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const glm::dvec3 apart = glm::abs(a[corner] - b[(corner + turn) % 3]);
            worst = std::max({worst, apart.x, apart.y, apart.z});
        }
        best = std::min(best, worst);
    }
    return best;
}

}  // namespace

TriangleSet::TriangleSet(std::vector<Triangle> triangles, double within) : within_(within) {
    ModelBox bounds;
    for (const Triangle& t : triangles) {
        for (const glm::dvec3& corner : t) bounds.add(corner);
    }
    // Cells, so that a distance rarely reaches into a second one.
    cellSize_ = std::max({4 * within, bounds.edge() / kCellsAlongModel, std::numeric_limits<double>::min()});
    entries_.reserve(triangles.size());
    for (const Triangle& t : triangles) entries_.push_back({cellOf(leastCorner(t)), t, false});
    std::ranges::sort(entries_, {}, &Entry::cell);
}

// Cells that share a number only cost time.
std::uint64_t TriangleSet::cellOf(const glm::dvec3& leastCorner) const {
    const glm::dvec3 cell = glm::floor(leastCorner / cellSize_) + 0.0;  // no -0
    const std::array bytes{cell.x, cell.y, cell.z};
    return XXH3_64bits(bytes.data(), sizeof(bytes));
}

TriangleSet::Entry* TriangleSet::closestIn(std::uint64_t cell, const Triangle& triangle, double& distance) {
    Entry* closest = nullptr;
    for (Entry& entry : std::ranges::equal_range(entries_, cell, {}, &Entry::cell)) {
        if (entry.taken) continue;
        const double apart = distanceBetween(triangle, entry.triangle);
        if (closest ? apart < distance : apart <= distance) closest = &entry, distance = apart;
    }
    return closest;
}

std::optional<double> TriangleSet::take(const Triangle& triangle) {
    const glm::dvec3 low = leastCorner(triangle) - within_, high = leastCorner(triangle) + within_;
    std::array<std::uint64_t, 8> cells{};
    for (std::size_t i = 0; i < 8; ++i)
        cells[i] = cellOf({(i & 1 ? high : low).x, (i & 2 ? high : low).y, (i & 4 ? high : low).z});
    std::ranges::sort(cells);
    Entry* best = nullptr;
    double distance = within_;
    for (auto cell = cells.begin(); cell != cells.end(); cell = std::upper_bound(cell, cells.end(), *cell)) {
        if (Entry* closest = closestIn(*cell, triangle, distance)) best = closest;
    }
    if (!best) return std::nullopt;
    best->taken = true;
    return distance;
}

std::vector<Triangle> TriangleSet::left() const {
    std::vector<Triangle> triangles;
    for (const Entry& entry : entries_) {
        if (!entry.taken) triangles.push_back(entry.triangle);
    }
    return triangles;
}

}  // namespace iwalk::tools
