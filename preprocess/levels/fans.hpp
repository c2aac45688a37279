#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <unordered_map>
#include <vector>

namespace iwalk {

// A triangle and its normal, as they change.
struct Face {
    std::array<std::uint32_t, 3> corners;  // points
    glm::vec3 normal;                      // unit; 0 without area

    bool has(std::uint32_t point) const {
        return corners[0] == point || corners[1] == point || corners[2] == point;
    }
    // Of what has become a line: all corners are one point.
    bool isGone() const { return corners[0] == corners[1]; }
    void setNormal(const std::vector<glm::vec3>& points) {
        const glm::vec3& a = points[corners[0]];
        const glm::vec3 cross = glm::cross(points[corners[1]] - a, points[corners[2]] - a);
        const float length = glm::length(cross);
        normal = length > 0 ? cross / length : glm::vec3(0);
    }
};

// The triangles around each point, as they change.
class Fans {
  public:
    Fans(const std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t points) : places_(points) {
        for (const auto& triangle : triangles) {
            for (const std::uint32_t point : triangle) ++places_[point].count;
        }
        std::size_t next = 0;
        for (Place& place : places_) {
            place.first = next;
            place.room = place.count;
            next += place.count;
            place.count = 0;
        }
        pool_.resize(next);
        for (std::uint32_t t = 0; t < triangles.size(); ++t) {
            for (const std::uint32_t point : triangles[t]) {
                Place& place = places_[point];
                pool_[place.first + place.count++] = t;
            }
        }
    }

    std::span<const std::uint32_t> of(std::uint32_t point) const {
        return {pool_.data() + places_[point].first, places_[point].count};
    }

    // Once; the order of the others stays. From a very long fan triangles go together, when half of them are
    // gone: isGone(triangle) must be true from now on. One by one a point with a million triangles would take
    // time with the square of them.
    template <class IsGone>
    void remove(std::uint32_t point, std::uint32_t triangle, IsGone isGone) {
        Place& place = places_[point];
        if (place.count > kLong) {
            if (2 * ++gone_[point] >= place.count) tidy(point, isGone);
            return;
        }
        const auto begin = pool_.begin() + static_cast<std::ptrdiff_t>(place.first);
        const auto end = begin + static_cast<std::ptrdiff_t>(place.count);
        const auto found = std::find(begin, end, triangle);
        if (found == end) return;
        std::copy(found + 1, end, found);
        --place.count;
    }

    // What is gone from the point's fan is no longer in it.
    template <class IsGone>
    void tidy(std::uint32_t point, IsGone isGone) {
        Place& place = places_[point];
        if (place.count <= kLong || gone_.erase(point) == 0) return;
        const auto begin = pool_.begin() + static_cast<std::ptrdiff_t>(place.first);
        const auto end = begin + static_cast<std::ptrdiff_t>(place.count);
        place.count = static_cast<std::uint32_t>(std::remove_if(begin, end, isGone) - begin);
    }

    void append(std::uint32_t point, std::span<const std::uint32_t> triangles) {
        Place& place = places_[point];
        const std::uint32_t count = place.count + static_cast<std::uint32_t>(triangles.size());
        if (count > place.room) move(place, count);
        std::ranges::copy(triangles, pool_.begin() + static_cast<std::ptrdiff_t>(place.first + place.count));
        place.count = count;
    }

    void clear(std::uint32_t point) { places_[point].count = 0; }

  private:
    static constexpr std::uint32_t kLong = 1024;
    struct Place {
        std::size_t first = 0;
        std::uint32_t count = 0, room = 0;
    };

    // To the end of the pool, with room to grow.
    void move(Place& place, std::uint32_t count) {
        const std::size_t first = pool_.size();
        place.room = count + count / 2;
        pool_.resize(first + place.room);
        std::copy_n(pool_.begin() + static_cast<std::ptrdiff_t>(place.first), place.count,
                    pool_.begin() + static_cast<std::ptrdiff_t>(first));
        place.first = first;
    }

    std::vector<Place> places_;
    std::vector<std::uint32_t> pool_;
    std::unordered_map<std::uint32_t, std::uint32_t> gone_;  // of long fans: triangles still to be removed
};

}  // namespace iwalk
