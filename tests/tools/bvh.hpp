#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "common/geometry.hpp"

namespace iwalk::tools {

// Corners in model space. Seen from both sides; degenerate ones are never hit.
using Triangle = std::array<glm::dvec3, 3>;

// A tree of boxes over triangles. Node 0 is the root.
struct Bvh {
    struct Node {
        ModelBox box;             // of all triangles below
        std::uint32_t first = 0;  // leaf: into `order`; interior: the first of two neighbouring children
        std::uint32_t count = 0;  // triangles of a leaf; 0: interior
    };
    std::vector<Node> nodes;           // empty when there are no triangles
    std::vector<std::uint32_t> order;  // indices of triangles, leaf by leaf

    static constexpr int kMaxDepth = 80;  // levels below the root
};

Bvh buildBvh(const std::vector<Triangle>& triangles);

}  // namespace iwalk::tools
