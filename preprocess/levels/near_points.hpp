#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <span>
#include <utility>
#include <vector>

namespace iwalk {

// Points by place: cells of space, hashed into a table of rows. Cells are twice as wide as the farthest
// reach, so a search looks into two or three of them as a rule.
class NearPoints {
  public:
    using Found = std::pair<float, std::uint32_t>;  // distance, point

    // `numbers` of `points`, which are kept by reference; `reach`: the farthest that will be asked for.
    NearPoints(const std::vector<glm::vec3>& points, std::span<const std::uint32_t> numbers, float reach)
        : points_(points), perCell_(0.5f / reach), mask_(std::bit_ceil(2 * numbers.size() + 1) - 1) {
        starts_.assign(mask_ + 2, 0);
        for (const std::uint32_t number : numbers) ++starts_[rowOf(cellOf(points[number])) + 1];
        for (std::size_t row = 0; row <= mask_; ++row) starts_[row + 1] += starts_[row];
        std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
        entries_.resize(numbers.size());
        for (const std::uint32_t number : numbers) {
            entries_[next[rowOf(cellOf(points[number]))]++] = {points[number], number};
        }
    }

    // All but `number` itself within `reach`, nearest first; equally near ones by number.
    void find(std::uint32_t number, float reach, std::vector<Found>& found) const {
        found.clear();
        const glm::vec3& from = points_[number];
        const glm::ivec3 low = cellOf(from - glm::vec3(reach)), high = cellOf(from + glm::vec3(reach));
        glm::ivec3 cell;
        for (cell.z = low.z; cell.z <= high.z; ++cell.z) {
            for (cell.y = low.y; cell.y <= high.y; ++cell.y) {
                for (cell.x = low.x; cell.x <= high.x; ++cell.x) look(cell, number, reach, found);
            }
        }
        std::ranges::sort(found);
    }

  private:
    struct Entry {
        glm::vec3 point;
        std::uint32_t number;
    };
    glm::ivec3 cellOf(const glm::vec3& p) const { return glm::ivec3(glm::floor(p * perCell_)); }
    std::size_t rowOf(const glm::ivec3& cell) const {
        std::uint64_t h = static_cast<std::uint32_t>(cell.x) * 0x9e3779b97f4a7c15u;
        h = (h ^ h >> 29 ^ static_cast<std::uint32_t>(cell.y)) * 0xbf58476d1ce4e5b9u;
        h = (h ^ h >> 32 ^ static_cast<std::uint32_t>(cell.z)) * 0x94d049bb133111ebu;
        return static_cast<std::size_t>(h ^ h >> 31) & mask_;
    }
    void look(const glm::ivec3& cell, std::uint32_t number, float reach, std::vector<Found>& found) const {
        const std::size_t row = rowOf(cell);
        for (std::size_t i = starts_[row]; i < starts_[row + 1]; ++i) {
            const Entry& other = entries_[i];
            const glm::vec3 way = other.point - points_[number];
            const float square = glm::dot(way, way);
            if (square > reach * reach || other.number == number || cellOf(other.point) != cell) continue;
            found.emplace_back(std::sqrt(square), other.number);
        }
    }

    const std::vector<glm::vec3>& points_;
    float perCell_;
    std::size_t mask_;
    std::vector<std::uint32_t> starts_;
    std::vector<Entry> entries_;
};

}  // namespace iwalk
