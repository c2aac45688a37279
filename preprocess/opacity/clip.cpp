#include "preprocess/opacity/clip.hpp"

#include <algorithm>
#include <cmath>

// Sutherland and Hodgman 1974, "Reentrant polygon clipping". Each crossing is computed from its edge's ends
// in a fixed order, whichever way round the edge is passed.
namespace iwalk {
namespace {

struct Polygon {
    std::array<glm::dvec3, kMaxClippedCorners> corners;
    std::size_t count = 0;

    void add(const glm::dvec3& corner) { corners[count++] = corner; }
};

bool before(const glm::dvec3& a, const glm::dvec3& b) {
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
}

glm::dvec3 crossing(glm::dvec3 a, glm::dvec3 b, std::size_t axis, double plane) {
    if (before(b, a)) std::swap(a, b);
    const double t = (plane - a[axis]) / (b[axis] - a[axis]);
    glm::dvec3 point = a + t * (b - a);
    point[axis] = plane;
    return point;
}

// Keeps what is on the inner side: sign * (coordinate - plane) >= 0.
Polygon clipSide(const Polygon& polygon, std::size_t axis, double plane, double sign) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const glm::dvec3& a = polygon.corners[i];
        const glm::dvec3& b = polygon.corners[i + 1 == polygon.count ? 0 : i + 1];
        const bool aInside = sign * (a[axis] - plane) >= 0, bInside = sign * (b[axis] - plane) >= 0;
        if (aInside) kept.add(a);
        if (aInside != bInside) kept.add(crossing(a, b, axis, plane));
    }
    return kept;
}

// Finite, and not all of it on the outer side of one plane.
bool mayTouchCell(std::span<const glm::vec3, 3> t) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float a = t[0][axis], b = t[1][axis], c = t[2][axis];
        if (!std::isfinite(a) || !std::isfinite(b) || !std::isfinite(c)) return false;
        if (std::max({a, b, c}) < 0 || std::min({a, b, c}) > 1) return false;
    }
    return true;
}

}  // namespace

ClippedPolygon clipToCell(std::span<const glm::vec3, 3> triangle) {
    ClippedPolygon result;
    if (!mayTouchCell(triangle)) return result;
    Polygon polygon;
    for (const glm::vec3& corner : triangle) polygon.add(glm::dvec3(corner));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
        if (low < 0) polygon = clipSide(polygon, axis, 0, 1);
        if (high > 1) polygon = clipSide(polygon, axis, 1, -1);
    }
    // Crossings may be outside by a rounding error.
    for (std::size_t i = 0; i < polygon.count; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            result.corners[i][axis] = static_cast<float>(std::clamp(polygon.corners[i][axis], 0.0, 1.0));
    }
    result.count = polygon.count < 3 ? 0 : polygon.count;
    return result;
}

}  // namespace iwalk
