#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "common/camera_path.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// How a screen's pixels and the directions from the eye belong together, in double. For a vector v from the
// eye, in model axes and any unit: toPixels * v = (x D, y D, D), where (x, y) is its place on the screen in
// px (origin top left, y down, pixel centres at .5) and D its distance along the screen's normal, in v's
// unit. toDirection is the inverse: toDirection * (x, y, 1) is the direction of that place with D = 1.
// (Off-axis projection from the screen's corners: Kooima 2008, "Generalized perspective projection", without
// matrices of clip space.)
struct ScreenProjection {
    glm::dmat3 toPixels{1}, toDirection{1};
};

// The camera turns wall space into model space: -z to target - eye, y towards up.
ScreenProjection projectScreen(const Screen& screen, const Camera& camera);

// The part of space that a rectangle of a screen shows: planes through the eye; v (from the eye, model axes)
// is inside when dot(planes[i], v) >= 0 for all i, and its D is at least `near`.
struct Frustum {
    glm::dvec3 planes[4];
    glm::dvec3 forward;  // D = dot(forward, v)
    double near = 0;     // in v's unit
};

// `margin` px are added on all sides: one covers the snapping of vertices.
Frustum frustumOf(const ScreenProjection& projection, const PixelRect& rect, double margin, double near);

}  // namespace iwalk
