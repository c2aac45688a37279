#include "preprocess/build/split.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "preprocess/build/lattice.hpp"

namespace iwalk {
namespace {

constexpr double kSlab = static_cast<double>(kMostTriangleSteps);

using Polygon = std::vector<Corner>;  // convex

// Where the edge from `low` to `high`, on either side of it, meets the plane.
Corner meeting(const Corner& low, const Corner& high, glm::length_t axis, double plane) {
    const double part = (plane - low.position[axis]) / (high.position[axis] - low.position[axis]);
    Corner corner = low;
    corner.position += part * (high.position - low.position);
    corner.position[axis] = plane;
    corner.color = 0;
    for (unsigned shift = 0; shift < 32; shift += 8) {
        const double from = low.color >> shift & 255, to = high.color >> shift & 255;
        corner.color |= static_cast<std::uint32_t>(std::lround(from + part * (to - from))) << shift;
    }
    const glm::dvec3 normal =
        glm::dvec3(low.normal) + part * (glm::dvec3(high.normal) - glm::dvec3(low.normal));
    if (glm::length(normal) > 0) corner.normal = glm::vec3(glm::normalize(normal));
    return corner;
}

struct Halves {
    Polygon below, above;
};
Halves partAt(const Polygon& polygon, glm::length_t axis, double plane) {
    Halves halves;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
        const double before = from.position[axis], after = to.position[axis];
        if (before <= plane) halves.below.push_back(from);
        if (before >= plane) halves.above.push_back(from);
        if ((before < plane) == (after < plane) || before == plane || after == plane) continue;
        // The same for all triangles that share the edge, whichever way they go.
        const Corner corner =
            before < plane ? meeting(from, to, axis, plane) : meeting(to, from, axis, plane);
        halves.below.push_back(corner);
        halves.above.push_back(corner);
    }
    return halves;
}

std::pair<double, double> extent(const Polygon& polygon, glm::length_t axis) {
    const auto [low, high] = std::ranges::minmax_element(
        polygon, {}, [axis](const Corner& corner) { return corner.position[axis]; });
    return {low->position[axis], high->position[axis]};
}

// Cuts what is left of the polygons into slabs along one axis, whose planes lie half a slab from the middle
// and on: none goes through what is near it.
std::vector<Polygon> slabs(std::vector<Polygon> polygons, glm::length_t axis, double middle) {
    std::vector<Polygon> result;
    for (Polygon& polygon : polygons) {
        const auto [low, high] = extent(polygon, axis);
        double plane = (std::floor((low - middle) / kSlab - 0.5) + 1.5) * kSlab + middle;
        for (; plane < high; plane += kSlab) {
            Halves halves = partAt(polygon, axis, plane);
            if (halves.below.size() > 2) result.push_back(std::move(halves.below));
            polygon = std::move(halves.above);
        }
        if (polygon.size() > 2) result.push_back(std::move(polygon));
    }
    return result;
}

void addFan(const Polygon& polygon, std::vector<Triangle>& triangles) {
    for (std::size_t i = 2; i < polygon.size(); ++i)
        triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
}

}  // namespace

SplitTriangle splitTriangle(const Triangle& triangle, const glm::dvec3& middle) {
    SplitTriangle result;
    Polygon polygon(triangle.begin(), triangle.end());
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = extent(polygon, axis);
        result.isCut = result.isCut || high - low > kLongestWhole;
    }
    for (glm::length_t axis = 0; axis < 3 && result.isCut; ++axis) {
        polygon = partAt(polygon, axis, middle[axis] - kReach).above;
        if (!polygon.empty()) polygon = partAt(polygon, axis, middle[axis] + kReach).below;
        if (polygon.size() < 3) return result;
    }
    std::vector<Polygon> polygons{std::move(polygon)};
    for (glm::length_t axis = 0; axis < 3; ++axis) polygons = slabs(std::move(polygons), axis, middle[axis]);
    for (const Polygon& piece : polygons) addFan(piece, result.pieces);
    return result;
}

}  // namespace iwalk
