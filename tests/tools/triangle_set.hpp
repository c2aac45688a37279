#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "tests/tools/bvh.hpp"

namespace iwalk::tools {

// Triangles to be paired with those of another model, one to one.
class TriangleSet {
  public:
    // `within`: how far corners may lie apart in each axis, model units, finite and at least 0.
    TriangleSet(std::vector<Triangle> triangles, double within);

    // Takes out the triangle closest to `triangle` of those whose corners all lie within the distance from
    // its own, in the same order round. Returns how far they lie apart at most; nullopt: there is none.
    std::optional<double> take(const Triangle& triangle);

    // What has not been taken out.
    std::vector<Triangle> left() const;

  private:
    struct Entry {
        std::uint64_t cell;
        Triangle triangle;
        bool taken;
    };
    std::uint64_t cellOf(const glm::dvec3& leastCorner) const;
    Entry* closestIn(std::uint64_t cell, const Triangle& triangle, double& distance);

    double within_;
    double cellSize_;
    std::vector<Entry> entries_;  // by cell
};

}  // namespace iwalk::tools
