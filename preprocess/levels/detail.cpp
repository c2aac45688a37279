#include "preprocess/levels/detail.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/dataset/hierarchy.hpp"
#include "preprocess/levels/collapse.hpp"
#include "preprocess/levels/numbers.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kSampleTriangles = 512;  // about one vertex for every 16 of these
// This part of the vertices can go at the finest level. Raised: fewer levels, so less to store and to make,
// and a larger step from full resolution to the next.
constexpr double kGoing = 0.9;
// Nodes with fewer triangles are small change.
constexpr std::size_t kLeastTriangles = 64;

// The triangles around a sample of the points.
class Sampled {
  public:
    Sampled(const RecordFormat& format, const Slice& slice) : format_(format) {
        // Every 2^k-th position by its hash: the same ones in whatever order triangles come.
        const std::uint64_t mask =
            std::bit_floor(std::max<std::size_t>(slice.count / kSampleTriangles, 1)) - 1;
        for (std::size_t i = 0; i < slice.count; ++i) add(slice.record(i, format.words()), mask);
    }

    std::vector<float> errors() { return collapseErrors(mesh_, sample_, kEdgesPerError); }

  private:
    void add(const std::uint32_t* record, std::uint64_t mask) {
        std::array<bool, 3> chosen{};
        for (std::size_t c = 0; c < 3; ++c)
            chosen[c] = (hashOf(format_.position(record, c)) >> 32 & mask) == 0;
        if (!chosen[0] && !chosen[1] && !chosen[2]) return;
        std::array<std::uint32_t, 3> triangle{};
        for (std::size_t c = 0; c < 3; ++c) {
            const CellPoint position = format_.position(record, c);
            const auto [point, isNew] = points_.add(position);
            if (isNew) addPoint(position);
            if (isNew && chosen[c]) sample_.push_back(point);
            triangle[c] = point;
        }
        mesh_.triangles.push_back(triangle);
    }

    void addPoint(const CellPoint& position) {
        const auto relative = [&](glm::length_t axis) {
            return static_cast<float>(static_cast<std::int64_t>(position[axis] - points_[0][axis]));
        };
        mesh_.points.emplace_back(relative(0), relative(1), relative(2));
        mesh_.errors.push_back(0);
        mesh_.held.push_back(0);
    }

    const RecordFormat& format_;
    Numbers<CellPoint, PointHash> points_;
    CollapseMesh mesh_;
    std::vector<std::uint32_t> sample_;
};

}  // namespace

int finestLevel(const RecordFormat& format, const Slice& slice, int depth) {
    if (slice.count < kLeastTriangles) return depth - 1;
    std::vector<float> errors = Sampled(format, slice).errors();
    if (errors.empty()) return depth - 1;
    const auto place =
        errors.begin() + static_cast<std::ptrdiff_t>(kGoing * static_cast<double>(errors.size() - 1));
    std::ranges::nth_element(errors, place);
    if (!std::isfinite(*place)) return depth - 1;
    // e_l = 2^(rootCellLog2 - 7 - l); not below a step.
    const double error = std::max(1.0, static_cast<double>(*place));
    const int level =
        static_cast<int>(std::floor(std::log2(levelErrorSteps(format.rootCellLog2(), 0) / error)));
    return std::max(level, depth - 1);
}

}  // namespace iwalk
