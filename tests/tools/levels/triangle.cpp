#include "tests/tools/levels/triangle.hpp"

#include <algorithm>

namespace iwalk::levels {
namespace {

// Heights below this share of the longest side count as none: they are within the rounding of the normal.
constexpr double kFlat = 1e-12;

// From the origin to the side from a to a + d.
double toSide(const glm::dvec3& a, const glm::dvec3& d, double squaredLength) {
    const double along = squaredLength > 0 ? std::clamp(-glm::dot(a, d) / squaredLength, 0.0, 1.0) : 0;
    const glm::dvec3 nearest = a + along * d;
    return glm::dot(nearest, nearest);
}

}  // namespace

// The nearest point is on a side, unless the foot of the perpendicular is inside all three.
double squaredDistance(const glm::dvec3& point, const FixedTriangle& triangle) {
    const glm::dvec3 a = toDouble(triangle[0]) - point, b = toDouble(triangle[1]) - point,
                     c = toDouble(triangle[2]) - point;
    const glm::dvec3 ab = b - a, bc = c - b, ca = a - c, normal = glm::cross(ab, -ca);
    const double lengths[3] = {glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)};
    const double squaredNormal = glm::dot(normal, normal);
    const double longest = std::max({lengths[0], lengths[1], lengths[2]});
    if (squaredNormal > kFlat * kFlat * longest * longest) {
        const bool inside = glm::dot(glm::cross(normal, ab), a) <= 0 &&
                            glm::dot(glm::cross(normal, bc), b) <= 0 &&
                            glm::dot(glm::cross(normal, ca), c) <= 0;
        const double height = glm::dot(normal, a);
        if (inside) return height * height / squaredNormal;
    }
    return std::min({toSide(a, ab, lengths[0]), toSide(b, bc, lengths[1]), toSide(c, ca, lengths[2])});
}

}  // namespace iwalk::levels
