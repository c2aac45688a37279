#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace iwalk {

inline float squared(const glm::vec3& v) {
    return glm::dot(v, v);
}

// Distance of p from the segment a b.
inline float segmentDistance(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 along = b - a;
    const float length = squared(along);
    const float t = length > 0 ? std::clamp(glm::dot(p - a, along) / length, 0.0f, 1.0f) : 0.0f;
    return glm::length(p - a - t * along);
}

// Distance of p from the triangle a b c, whose unit normal is n.
inline float triangleDistance(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                              const glm::vec3& n) {
    const bool inside = glm::dot(glm::cross(b - a, p - a), n) >= 0 &&
                        glm::dot(glm::cross(c - b, p - b), n) >= 0 &&
                        glm::dot(glm::cross(a - c, p - c), n) >= 0;
    if (inside) return std::abs(glm::dot(p - a, n));
    return std::min({segmentDistance(p, a, b), segmentDistance(p, b, c), segmentDistance(p, c, a)});
}

}  // namespace iwalk
