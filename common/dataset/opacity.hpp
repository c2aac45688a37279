#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

// The directions in which a leaf's opacity is sampled: Correa 2004, section 3.2, takes an arbitrary number of
// viewpoints around a leaf, typically 20, and at run time the coefficient of the nearest (section 4.2). Here
// they are the vertices of a regular dodecahedron, the most even set of 20 with opposite pairs. No direction
// is farther than 37.4 degrees from its sample.
namespace iwalk {

inline constexpr std::size_t kOpacityDirections = 20;
// Direction i + kOpacityAxes is opposite to direction i.
inline constexpr std::size_t kOpacityAxes = kOpacityDirections / 2;

namespace detail {
// Of (1, 1, 1), and of (0, 1/p, p) where p is the golden ratio, divided by the square root of 3.
inline constexpr float kCorner = 0.577350269F, kShort = 0.356822090F, kLong = 0.934172359F;
}  // namespace detail

// Unit vectors in model axes, in the order of NodeRecord::opacity.
inline constexpr std::array<glm::vec3, kOpacityDirections> kOpacityDirection = [] {
    using namespace detail;
    std::array<glm::vec3, kOpacityDirections> directions{
        glm::vec3(kCorner, kCorner, kCorner),  glm::vec3(-kCorner, kCorner, kCorner),
        glm::vec3(kCorner, -kCorner, kCorner), glm::vec3(kCorner, kCorner, -kCorner),
        glm::vec3(0, kShort, kLong),           glm::vec3(0, -kShort, kLong),
        glm::vec3(kLong, 0, kShort),           glm::vec3(kLong, 0, -kShort),
        glm::vec3(kShort, kLong, 0),           glm::vec3(-kShort, kLong, 0)};
    for (std::size_t i = 0; i < kOpacityAxes; ++i) {
        const glm::vec3& d = directions[i];
        directions[i + kOpacityAxes] = glm::vec3(-d.x, -d.y, -d.z);
    }
    return directions;
}();

// The sample nearest to `direction` (model axes, any finite length); of equally near ones, and for a zero
// vector, one of them.
inline std::size_t nearestDirection(const glm::vec3& direction) {
    std::size_t nearest = 0;
    float most = 0;
    for (std::size_t i = 0; i < kOpacityAxes; ++i) {
        const float cosine = glm::dot(kOpacityDirection[i], direction);
        if (std::abs(cosine) <= std::abs(most)) continue;
        most = cosine;
        nearest = cosine < 0 ? i + kOpacityAxes : i;
    }
    return nearest;
}

}  // namespace iwalk
