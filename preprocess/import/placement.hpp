#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <optional>
#include <vector>

#include "preprocess/import/importer.hpp"

namespace iwalk {

// Moves what an importer hands out to another place.
class Placement {
  public:
    // `matrix` is affine; points are columns. `color` (RGBA8) replaces all colours of the triangles.
    explicit Placement(const glm::dmat4& matrix, std::optional<std::uint32_t> color = {});

    glm::dvec3 point(const glm::dvec3& p) const { return glm::dvec3(matrix_ * glm::dvec4(p, 1)); }
    // Appends the triangles, moved; a mirrored one gets its corners turned round, so that its front stays
    // its front. Returns how many were left out because a corner got out of the numbers' range.
    std::uint64_t append(std::span<const Triangle> triangles, std::vector<Triangle>& out) const;
    // The box of what a box's contents become, or a larger one.
    ModelBox box(const ModelBox& from) const;
    // The smallest factor, other than 0, by which it stretches an axis.
    double leastScale() const;

  private:
    glm::dmat4 matrix_;
    glm::dmat3 normals_;
    bool mirrored_;
    std::optional<std::uint32_t> color_;
};

// Turns y up into z up: (x, y, z) becomes (x, -z, y).
Placement yUpToZUp();

}  // namespace iwalk
