#include "preprocess/levels/cells.hpp"

#include <algorithm>

namespace iwalk {
namespace {

// A weight is spread over smaller and smaller parts of its box until each is this small a part of a cell.
constexpr std::uint64_t kGrain = 8;
constexpr int kMostSpread = 4;
// The edge of the cell that everything lies in.
constexpr unsigned kTopLog2 = 63;
// Multiples of a fifth of that cell's edge, 1 to 4 of them, are the corners of octrees whose planes are at
// least a fifth of the smaller cell away from one another, whatever the cells: modulo 2^j, they are fifths of
// 2^j.
constexpr std::uint64_t kFifth = (std::uint64_t{1} << 62) / 5;
constexpr int kTurns = 4;

struct Point {
    CellPoint at;
    std::uint64_t triangles;
};

class Cutter {
  public:
    Cutter(int errorLog2, const CellSizes& sizes)
        : most_(sizes.mostTriangles), leastEdge_(sizes.leastEdge), mostEdge_(sizes.mostEdge) {
        for (int axis = 0; axis < 3; ++axis) {
            const int turn = ((errorLog2 + axis) % kTurns + kTurns) % kTurns;
            shift_[axis] =
                static_cast<std::int64_t>(static_cast<std::uint64_t>(turn + 1) * kFifth) + kMostSteps;
        }
    }

    void spread(const Weight& weight, int times) {
        if (weight.triangles == 0) return;
        const auto edge = static_cast<std::int64_t>(weight.edge);
        if (times == kMostSpread || edge <= 1 || weight.triangles * kGrain <= most_) {
            points_.push_back({CellPoint(weight.low + edge / 2 + shift_), weight.triangles});
            return;
        }
        const std::int64_t half = edge / 2;
        for (unsigned octant = 0; octant < 8; ++octant) {
            const LatticePoint corner(octant & 1 ? half : 0, octant & 2 ? half : 0, octant & 4 ? half : 0);
            const auto part = static_cast<std::uint64_t>(half);
            spread({weight.low + corner, part, (weight.triangles + octant) / 8}, times + 1);
        }
    }

    std::vector<LatticeCell> cut() {
        cutBox(points_, CellPoint(0), kTopLog2);
        return std::move(cells_);
    }

  private:
    // Lattice coordinates are not farther from 0; moved by this and the octree's corner, none are negative.
    static constexpr std::int64_t kMostSteps = std::int64_t{1} << 61;

    void cutBox(std::span<Point> points, const CellPoint& low, unsigned edgeLog2) {
        std::uint64_t triangles = 0;
        for (const Point& point : points) triangles += point.triangles;
        const std::uint64_t half = std::uint64_t{1} << (edgeLog2 - 1);
        const bool isSmall = triangles <= most_ && 2 * half <= mostEdge_;
        if (triangles == 0 || isSmall || half < leastEdge_ || half < 2) return add(low, 2 * half);
        const auto octantOf = [&](const Point& point) {
            const auto upper = [&](int axis) { return point.at[axis] - low[axis] >= half ? 1u : 0u; };
            return upper(0) | upper(1) << 1 | upper(2) << 2;
        };
        const unsigned first = octantOf(points.front());
        const bool together =
            std::ranges::all_of(points, [&](auto& point) { return octantOf(point) == first; });
        for (unsigned octant = 0; octant < 8; ++octant) {
            const auto inside = [&](const Point& point) { return octantOf(point) == octant; };
            std::size_t count = octant == first ? points.size() : 0;
            if (!together) {
                const auto rest = std::stable_partition(points.begin(), points.end(), inside);
                count = static_cast<std::size_t>(rest - points.begin());
            }
            const CellPoint corner(octant & 1 ? half : 0, octant & 2 ? half : 0, octant & 4 ? half : 0);
            cutBox(points.first(count), low + corner, edgeLog2 - 1);
            points = points.subspan(count);
        }
    }

    void add(const CellPoint& low, std::uint64_t edge) {
        // Unsigned: the top is 2^63.
        cells_.push_back(
            {LatticePoint(low - CellPoint(shift_)), LatticePoint(low + edge - CellPoint(shift_))});
    }

    std::uint64_t most_, leastEdge_, mostEdge_;
    LatticePoint shift_{0, 0, 0};
    std::vector<Point> points_;
    std::vector<LatticeCell> cells_;
};

}  // namespace

std::vector<LatticeCell> cutCells(std::span<const Weight> weights, int errorLog2, const CellSizes& sizes) {
    Cutter cutter(errorLog2, sizes);
    for (const Weight& weight : weights) cutter.spread(weight, 0);
    return cutter.cut();
}

std::optional<SpaceCell> inRoot(const LatticeCell& cell, const Lattice& lattice) {
    const std::int64_t edge = std::int64_t{1} << lattice.rootCellLog2;
    SpaceCell inside;
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        const std::int64_t root = lattice.rootCell[axis];
        const std::int64_t low = std::max(cell.low[axis], root),
                           high = std::min(cell.high[axis], root + edge);
        if (low >= high) return std::nullopt;
        inside.low[axis] = static_cast<std::uint64_t>(low - root);
        inside.high[axis] = static_cast<std::uint64_t>(high - root);
    }
    return inside;
}

}  // namespace iwalk
