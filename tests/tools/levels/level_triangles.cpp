#include "tests/tools/levels/level_triangles.hpp"

#include <cmath>

#include "common/check.hpp"

namespace iwalk::levels {
namespace {

// The entries' triangles, those of entries that morph to level `halfWayTo` half way there; -1: none.
Result<std::vector<FixedTriangle>> trianglesOf(const DatasetPages& pages, const FixedGrid& grid,
                                               const std::vector<EntryPlace>& entries, int halfWayTo) {
    std::uint64_t count = 0;
    for (const EntryPlace& place : entries) count += pages.entry(place).triangles;
    std::vector<FixedTriangle> triangles;
    triangles.reserve(count);
    const auto visit = [&](const EntryPlace& place, const DecodedPage& page, const Range& range) {
        const bool halfWay = !page.targets.empty() && pages.nextLevel(place) == halfWayTo;
        const std::vector<LatticePoint>& ends = halfWay ? page.targets : page.positions;
        for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; i += 3) {
            FixedTriangle triangle;
            for (std::uint32_t c = 0; c < 3; ++c) {
                const std::uint16_t vertex = page.indices[i + c];
                triangle[c] = grid.ofHalves(page.positions[vertex] + ends[vertex]);
            }
            triangles.push_back(triangle);
        }
    };
    RETURN_IF_ERROR(pages.visitRanges(entries, halfWayTo >= 0, visit));
    return triangles;
}

}  // namespace

FixedGrid::FixedGrid(const Hierarchy& hierarchy)
    : origin_(hierarchy.rootCell), log2_(static_cast<int>(hierarchy.rootCellLog2)) {}

Corner FixedGrid::ofHalves(const LatticePoint& twice) const {
    const int shift = kGridLog2 - 1 - log2_;  // parts of a half step, as a power of two
    Corner corner;
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t halves = twice[axis] - 2 * origin_[axis];
        const double parts = std::round(std::ldexp(static_cast<double>(halves), shift));
        CHECK_OP(std::abs(parts), <=, std::ldexp(1.0, kGridLog2 + 1));
        corner[axis] = static_cast<std::int32_t>(parts);
    }
    return corner;
}

double FixedGrid::unit(const Manifest& manifest) const {
    return std::ldexp(1.0, log2_ + manifest.stepExponent - kGridLog2);
}

Result<std::vector<FixedTriangle>> levelTriangles(const DatasetPages& pages, const FixedGrid& grid,
                                                  unsigned level) {
    return trianglesOf(pages, grid, pages.wholeModel(level), -1);
}

Result<std::vector<FixedTriangle>> halfMorphTriangles(const DatasetPages& pages, const FixedGrid& grid,
                                                      unsigned level) {
    return trianglesOf(pages, grid, pages.wholeModel(level + 1), static_cast<int>(level));
}

}  // namespace iwalk::levels
