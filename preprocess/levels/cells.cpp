#include "preprocess/levels/cells.hpp"

#include <algorithm>
#include <cmath>

namespace iwalk {
namespace {

// A weight is spread over smaller and smaller parts of its box until each is this small a part of a cell.
constexpr std::uint64_t kGrain = 8;
constexpr int kMostSpread = 4;

struct Point {
    CellPoint at;
    std::uint64_t triangles;
};

class Cutter {
  public:
    Cutter(unsigned rootCellLog2, unsigned level, std::uint64_t mostTriangles, std::uint64_t leastEdge)
        : most_(mostTriangles), leastEdge_(leastEdge), rootEdge_(std::uint64_t{1} << rootCellLog2) {
        // Multiples of the golden section never come near one another; each axis has its own.
        constexpr double kGolden = 0.6180339887498949;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const double turn = (level + 1) * kGolden + axis / 3.0;
            const double part = turn - std::floor(turn);
            shift_[static_cast<glm::length_t>(axis)] =
                static_cast<std::uint64_t>(part * static_cast<double>(rootEdge_));
        }
    }

    void spread(const Weight& weight, int times) {
        if (weight.triangles == 0) return;
        if (times == kMostSpread || weight.edge <= 1 || weight.triangles * kGrain <= most_) {
            points_.push_back({weight.low + weight.edge / 2, weight.triangles});
            return;
        }
        const std::uint64_t half = weight.edge / 2;
        for (unsigned octant = 0; octant < 8; ++octant) {
            const CellPoint corner(octant & 1 ? half : 0, octant & 2 ? half : 0, octant & 4 ? half : 0);
            spread({weight.low + corner, half, (weight.triangles + octant) / 8}, times + 1);
        }
    }

    std::vector<SpaceCell> cut() {
        // Shifted by less than one root cell, twice the root's edge holds everything.
        for (Point& point : points_) point.at += shift_;
        cutBox(points_, CellPoint(0), 2 * rootEdge_);
        return std::move(cells_);
    }

  private:
    void cutBox(std::span<Point> points, const CellPoint& low, std::uint64_t edge) {
        std::uint64_t triangles = 0;
        for (const Point& point : points) triangles += point.triangles;
        if (triangles <= most_ || edge / 2 < leastEdge_ || edge < 4) return add(low, edge);
        const std::uint64_t half = edge / 2;
        for (unsigned octant = 0; octant < 8; ++octant) {
            const CellPoint corner =
                low + CellPoint(octant & 1 ? half : 0, octant & 2 ? half : 0, octant & 4 ? half : 0);
            const auto inside = [&](const Point& point) {
                return SpaceCell{corner, corner + half}.contains(point.at);
            };
            const auto rest = std::stable_partition(points.begin(), points.end(), inside);
            const std::size_t count = static_cast<std::size_t>(rest - points.begin());
            cutBox(points.first(count), corner, half);
            points = points.subspan(count);
        }
    }

    // In steps from the root cell's corner again; what lies below it is cut off.
    void add(const CellPoint& low, std::uint64_t edge) {
        SpaceCell cell;
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            const std::uint64_t top = low[axis] + edge;
            if (top <= shift_[axis]) return;
            cell.low[axis] = low[axis] > shift_[axis] ? low[axis] - shift_[axis] : 0;
            cell.high[axis] = top - shift_[axis];
        }
        cells_.push_back(cell);
    }

    std::uint64_t most_, leastEdge_, rootEdge_;
    CellPoint shift_{0};
    std::vector<Point> points_;
    std::vector<SpaceCell> cells_;
};

}  // namespace

std::vector<SpaceCell> cutCells(std::span<const Weight> weights, unsigned rootCellLog2, unsigned level,
                                std::uint64_t mostTriangles, std::uint64_t leastEdge) {
    Cutter cutter(rootCellLog2, level, mostTriangles, leastEdge);
    for (const Weight& weight : weights) cutter.spread(weight, 0);
    return cutter.cut();
}

}  // namespace iwalk
