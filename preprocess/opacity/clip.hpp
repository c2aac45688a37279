#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>

namespace iwalk {

inline constexpr std::size_t kMaxClippedCorners = 32;

// A convex polygon: a triangle cut by the six sides of a cell. It has 9 corners at most, but for rounding: a
// side could then cut off every other corner.
struct ClippedPolygon {
    std::array<glm::vec3, kMaxClippedCorners> corners;
    std::size_t count = 0;  // 0: nothing is inside; else at least 3
};

// The part of a triangle inside [0, 1]^3. An edge that two triangles share is cut at the same points, to the
// last bit. Empty when a corner is not finite.
ClippedPolygon clipToCell(std::span<const glm::vec3, 3> triangle);

}  // namespace iwalk
