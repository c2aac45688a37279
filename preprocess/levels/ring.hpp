#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <experimental/simd>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace iwalk {

namespace stdx = std::experimental;

// What lies around a point: its neighbours, which have places in a ring, and its triangles. Coordinates are
// in arrays of their own and in lanes, so that loops over the ring become vector instructions.
class Ring {
  public:
    static constexpr std::size_t kMostFan = 48;  // triangles

    static constexpr std::uint32_t kNowhere = 0xffffffff;

    // From the point to a neighbour.
    struct Edge {
        std::uint32_t first;   // a triangle of the edge, its place in the fan
        std::uint32_t second;  // the other one, when count is 2
        std::uint32_t count;   // triangles at the edge
        int turns;             // those that have it first, in their order, less those that have it last
        bool feature;          // border, sharp fold, or two colours meet
    };
    // The point, then `after` and `before` of the ring, in the triangle's order.
    struct FanTriangle {
        std::uint32_t triangle;
        glm::vec3 normal;             // unit, or 0
        std::uint32_t after, before;  // places in the ring
        bool has(std::size_t place) const { return after == place || before == place; }
    };

    void clear() { size_ = fanSize_ = 0; }
    std::size_t size() const { return size_; }
    std::size_t fanSize() const { return fanSize_; }
    std::uint32_t point(std::size_t place) const { return points_[place]; }
    Edge& edge(std::size_t place) { return edges_[place]; }
    const Edge& edge(std::size_t place) const { return edges_[place]; }
    const FanTriangle& fan(std::size_t i) const { return fan_[i]; }
    // To a neighbour from the point, steps.
    glm::vec3 way(std::size_t place) const { return {x_[place], y_[place], z_[place]}; }

    // Of a neighbour, kNowhere when it has none yet.
    std::uint32_t find(std::uint32_t point) const {
        for (std::uint32_t place = 0; place < size_; ++place) {
            if (points_[place] == point) return place;
        }
        return kNowhere;
    }
    // The new neighbour's place.
    std::uint32_t add(std::uint32_t point, const glm::vec3& way) {
        const std::uint32_t place = static_cast<std::uint32_t>(size_++);
        points_[place] = point;
        edges_[place].count = 0;
        edges_[place].turns = 0;
        edges_[place].feature = false;
        x_[place] = way.x, y_[place] = way.y, z_[place] = way.z;
        return place;
    }
    void addTriangle(std::uint32_t triangle, const glm::vec3& normal, std::uint32_t after,
                     std::uint32_t before) {
        const std::uint32_t at = static_cast<std::uint32_t>(fanSize_++);
        // One by one: a copy of the whole would have to wait for its parts.
        fan_[at].triangle = triangle;
        fan_[at].normal = normal;
        fan_[at].after = after;
        fan_[at].before = before;
        for (const std::uint32_t place : {after, before}) {
            Edge& edge = edges_[place];
            (edge.count == 0 ? edge.first : edge.second) = at;
            ++edge.count;
        }
        ++edges_[after].turns;
        --edges_[before].turns;
    }

    // Whether the surface ends or folds by more than 90 degrees at the edge: one of its triangles has none on
    // the other side. Where triangles lie upon one another, that is not a matter of their number.
    bool endsAt(std::size_t place) const {
        const Edge& edge = edges_[place];
        if (edge.count == 1) return true;
        if (edge.count == 2 && edge.turns == 0)
            return glm::dot(fan_[edge.first].normal, fan_[edge.second].normal) < 0;
        for (std::size_t t = 0; t < fanSize_; ++t) {
            if (fan_[t].has(place) && !continues(t, place)) return true;
        }
        return false;
    }

    // Of each neighbour: the largest distance from the planes of the fan's triangles and, if asked for, from
    // the lines of the features.
    void findCosts(bool features) {
        for (std::size_t i = size_; i % Lanes::size() != 0; ++i) x_[i] = y_[i] = z_[i] = 0;
        for (std::size_t begin = 0; begin < size_; begin += Lanes::size()) {
            const Lanes x = lanes(x_, begin), y = lanes(y_, begin), z = lanes(z_, begin);
            Lanes cost = 0;
            for (std::size_t t = 0; t < fanSize_; ++t) {
                const glm::vec3& n = fan_[t].normal;
                cost = stdx::max(cost, stdx::abs(n.x * x + n.y * y + n.z * z));
            }
            if (features) cost = stdx::max(cost, fromLines(x, y, z));
            cost.copy_to(&costs_[begin], stdx::element_aligned);
        }
    }
    float& cost(std::size_t place) { return costs_[place]; }
    std::size_t cheapest() const {
        return static_cast<std::size_t>(
            std::min_element(costs_.begin(), costs_.begin() + static_cast<std::ptrdiff_t>(size_)) -
            costs_.begin());
    }

  private:
    using Lanes = stdx::fixed_size_simd<float, 8>;
    static constexpr std::size_t kMost = 2 * kMostFan;
    static_assert(kMost % Lanes::size() == 0);

    // From the edge's line to the third corner.
    glm::vec3 inward(const FanTriangle& triangle, std::size_t place) const {
        const glm::vec3 edge = way(place),
                        third = way(triangle.after == place ? triangle.before : triangle.after);
        const float length = glm::dot(edge, edge);
        return length > 0 ? third - (glm::dot(third, edge) / length) * edge : third;
    }
    bool continues(std::size_t t, std::size_t place) const {
        const glm::vec3 here = inward(fan_[t], place);
        for (std::size_t other = 0; other < fanSize_; ++other) {
            if (fan_[other].has(place) && glm::dot(here, inward(fan_[other], place)) < 0) return true;
        }
        return false;
    }

    static Lanes lanes(const std::array<float, kMost>& values, std::size_t begin) {
        return Lanes(&values[begin], stdx::element_aligned);
    }

    // The largest distance from the features' lines.
    Lanes fromLines(const Lanes& x, const Lanes& y, const Lanes& z) const {
        Lanes most = 0;  // squared
        for (std::size_t place = 0; place < size_; ++place) {
            const glm::vec3 line = way(place);
            const float length = glm::dot(line, line);
            if (!edges_[place].feature || length <= 0) continue;
            const Lanes along = (x * line.x + y * line.y + z * line.z) * (1 / length);
            const Lanes dx = x - along * line.x, dy = y - along * line.y, dz = z - along * line.z;
            most = stdx::max(most, dx * dx + dy * dy + dz * dz);
        }
        return stdx::sqrt(most);
    }

    std::size_t size_ = 0, fanSize_ = 0;
    std::array<float, kMost> x_{}, y_{}, z_{}, costs_{};
    std::array<std::uint32_t, kMost> points_{};
    std::array<Edge, kMost> edges_{};
    std::array<FanTriangle, kMostFan> fan_{};
};

}  // namespace iwalk
