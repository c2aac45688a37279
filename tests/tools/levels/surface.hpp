#pragma once

#include <cstdint>
#include <vector>

#include "tests/tools/levels/triangle.hpp"

namespace iwalk::levels {

// Triangles in a tree of boxes, for the distance of points to them. 36 bytes a triangle and about 20 for the
// tree; built in place, so that 24 million triangles take 1.4 GB.
class Surface {
  public:
    // Reorders the triangles. At least one.
    explicit Surface(std::vector<FixedTriangle> triangles);
    // From a point to the nearest triangle, in the corners' units. Thread-safe.
    double distance(const glm::dvec3& point) const;
    const std::vector<FixedTriangle>& triangles() const { return triangles_; }

  private:
    struct Node {
        Corner min, max;
        std::uint32_t first;  // leaf: into triangles_; interior: the first of two neighbouring children
        std::uint32_t count;  // triangles of a leaf; 0: interior
    };
    struct Part;
    // Squared.
    static double toBox(const glm::dvec3& point, const Node& node);
    std::uint32_t finishNode(const Part& part);
    std::uint32_t split(const Part& part);

    std::vector<FixedTriangle> triangles_;
    std::vector<Node> nodes_;
};

}  // namespace iwalk::levels
