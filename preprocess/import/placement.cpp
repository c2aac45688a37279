#include "preprocess/import/placement.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <utility>

#include "preprocess/import/vertex_output.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {
namespace {

// The inverse transposed, but for a positive factor; there is one also where there is no inverse.
glm::dmat3 normalMatrix(const glm::dmat3& m) {
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

}  // namespace

Placement::Placement(const glm::dmat4& matrix, std::optional<std::uint32_t> color)
    : matrix_(matrix),
      normals_(normalMatrix(glm::dmat3(matrix))),
      mirrored_(glm::determinant(glm::dmat3(matrix)) < 0),
      color_(color) {}

std::uint64_t Placement::append(std::span<const Triangle> triangles, std::vector<Triangle>& out) const {
    std::uint64_t lost = 0;
    for (Triangle triangle : triangles) {
        bool finite = true;
        for (Corner& corner : triangle) {
            corner.position = point(corner.position);
            finite = finite && isFinite(corner.position);
            if (color_) corner.color = *color_;
            if (corner.normal == glm::vec3(0)) continue;
            const glm::vec3 turned = unitOrZero(normals_ * glm::dvec3(corner.normal));
            if (turned != glm::vec3(0)) corner.normal = turned;
        }
        if (!finite) {
            ++lost;
            continue;
        }
        if (mirrored_) std::swap(triangle[1], triangle[2]);
        out.push_back(triangle);
    }
    return lost;
}

ModelBox Placement::box(const ModelBox& from) const {
    ModelBox moved;
    for (unsigned i = 0; i < 8 && !from.empty(); ++i) {
        moved.add(
            point(glm::dvec3((i & 1) != 0 ? from.max.x : from.min.x, (i & 2) != 0 ? from.max.y : from.min.y,
                             (i & 4) != 0 ? from.max.z : from.min.z)));
    }
    return moved;
}

double Placement::leastScale() const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double scale = glm::length(glm::dvec3(matrix_[axis]));
        if (scale > 0) least = std::min(least, scale);
    }
    return std::isfinite(least) ? least : 1;
}

Placement yUpToZUp() {
    return Placement(glm::dmat4(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1));
}

}  // namespace iwalk
