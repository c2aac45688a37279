#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>

namespace iwalk {

// An integer position on the dataset's absolute lattice; one step is 2^stepExponent model units.
using LatticePoint = glm::i64vec3;

// An axis-aligned box, both ends inclusive. Empty when min > max in any axis, as after construction.
template <class T>
struct Box {
    using Point = glm::vec<3, T>;
    Point min{std::numeric_limits<T>::max()};
    Point max{std::numeric_limits<T>::lowest()};

    bool empty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
    void add(const Point& p) { min = least(min, p), max = greatest(max, p); }
    void add(const Box& other) {
        if (!other.empty()) add(other.min), add(other.max);
    }
    bool contains(const Box& o) const {
        return o.empty() || (least(min, o.min) == min && greatest(max, o.max) == max);
    }
    // Of the longest side; of integers it must fit in T.
    T edge() const {
        return empty() ? T(0) : std::max({T(max.x - min.x), T(max.y - min.y), T(max.z - min.z)});
    }
    bool operator==(const Box&) const = default;

  private:
    static Point least(const Point& a, const Point& b) {
        return Point(std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z));
    }
    static Point greatest(const Point& a, const Point& b) {
        return Point(std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z));
    }
};

using LatticeBox = Box<std::int64_t>;
using ModelBox = Box<double>;

}  // namespace iwalk
