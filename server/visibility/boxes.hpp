#pragma once

#include <algorithm>
#include <glm/geometric.hpp>

#include "common/geometry.hpp"
#include "server/visibility/eye.hpp"
#include "server/wall/projection.hpp"

namespace iwalk {

// Whether the box [low, high] (from the eye, in the frustum's unit) may meet the frustum: the part of it that
// lies farthest along a plane decides for all of it.
inline bool meets(const Frustum& frustum, const glm::dvec3& low, const glm::dvec3& high) {
    const auto farthest = [&](const glm::dvec3& normal) {
        return std::max(normal.x * low.x, normal.x * high.x) + std::max(normal.y * low.y, normal.y * high.y) +
               std::max(normal.z * low.z, normal.z * high.z);
    };
    for (const glm::dvec3& plane : frustum.planes)
        if (farthest(plane) < 0) return false;
    return farthest(frustum.forward) >= frustum.near;
}

// Whether all of the box lies in the frustum.
inline bool contains(const Frustum& frustum, const glm::dvec3& low, const glm::dvec3& high) {
    const auto nearest = [&](const glm::dvec3& normal) {
        return std::min(normal.x * low.x, normal.x * high.x) + std::min(normal.y * low.y, normal.y * high.y) +
               std::min(normal.z * low.z, normal.z * high.z);
    };
    for (const glm::dvec3& plane : frustum.planes)
        if (nearest(plane) < 0) return false;
    return nearest(frustum.forward) >= frustum.near;
}

// Frustum in lattice steps.
inline bool meets(const Frustum& frustum, const LatticeEye& eye, const LatticeBox& box) {
    return meets(frustum, eye.to(box.min), eye.to(box.max));
}

}  // namespace iwalk
