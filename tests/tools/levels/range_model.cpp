#include "tests/tools/levels/range_model.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace iwalk::levels {
namespace {

double diagonalOf(const LatticeBox& box) {
    return box.empty() ? 0 : glm::length(glm::dvec3(box.max - box.min));
}

}  // namespace

std::size_t RangeModel::Hash::operator()(const Triple& key) const {
    std::uint64_t hash = 0;
    for (const std::int64_t value : key) {
        hash = (hash ^ static_cast<std::uint64_t>(value)) * 0x9e3779b97f4a7c15;
        hash ^= hash >> 32;
    }
    return hash;
}

std::uint32_t RangeModel::place(const LatticePoint& point) {
    const auto next = static_cast<std::uint32_t>(places_.size());
    const auto [found, added] = numbers_.try_emplace({point.x, point.y, point.z}, next);
    if (added) places_.emplace_back(point);
    return found->second;
}

MorphVertex RangeModel::vertex(const LatticePoint& from, const LatticePoint& target, int next) {
    const std::uint32_t a = place(from), b = place(target);
    const auto [found, added] = ways_.try_emplace({a, b, next}, static_cast<std::uint32_t>(ways_.size()));
    return {a, b, found->second};
}

std::uint32_t RangeModel::add(CutRange range) {
    ranges_.push_back(std::move(range));
    return static_cast<std::uint32_t>(ranges_.size() - 1);
}

LatticeBox RangeModel::bounds() const {
    LatticeBox box;
    for (const CutRange& range : ranges_) box.add(range.box);
    return box;
}

std::vector<double> RangeModel::diagonals(bool input) const {
    std::vector<double> largest(static_cast<std::size_t>(levels_), 0.0);
    for (const CutRange& range : ranges_) {
        const bool full = range.level == fullLevel();
        if (full && !input) continue;
        for (int level = full ? range.next + 1 : range.level; level <= (full ? levels_ - 1 : range.level);
             ++level) {
            double& diagonal = largest[static_cast<std::size_t>(level)];
            diagonal = std::max(diagonal, diagonalOf(range.box));
        }
    }
    return largest;
}

}  // namespace iwalk::levels
