#pragma once

#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

// Triangles and the distance to them: exact integer corners, everything else in double precision.
namespace iwalk::levels {

// Of +-2^30, so that differences fit.
using Corner = glm::i32vec3;
using FixedTriangle = std::array<Corner, 3>;

inline glm::dvec3 toDouble(const Corner& c) {
    return glm::dvec3(c);
}

// Twice the area's vector; zero, or as good as zero against the rounding of its terms, where a triangle is
// degenerate: then lineOf() is what is left of it.
inline glm::dvec3 normalOf(const FixedTriangle& t) {
    const glm::dvec3 a = toDouble(t[0]);
    return glm::cross(toDouble(t[1]) - a, toDouble(t[2]) - a);
}

inline double areaOf(const FixedTriangle& t) {
    return 0.5 * glm::length(normalOf(t));
}

// The ends of the longest side.
inline std::array<Corner, 2> lineOf(const FixedTriangle& t) {
    std::array<Corner, 2> longest{t[0], t[1]};
    for (std::size_t i = 1; i < 3; ++i) {
        const std::array<Corner, 2> side{t[i], t[(i + 1) % 3]};
        const auto squared = [](const std::array<Corner, 2>& s) {
            const glm::dvec3 d = toDouble(s[1]) - toDouble(s[0]);
            return glm::dot(d, d);
        };
        if (squared(side) > squared(longest)) longest = side;
    }
    return longest;
}

// To the nearest point of the triangle; of a degenerate one, to its sides and corners.
double squaredDistance(const glm::dvec3& point, const FixedTriangle& triangle);

}  // namespace iwalk::levels
