#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>

#include "common/geometry.hpp"

namespace iwalk {

// A position in steps from the root cell's lowest corner.
using CellPoint = glm::u64vec3;

// Positions may be this many steps from the lattice's origin, in each axis.
inline constexpr std::int64_t kMaxSteps = std::int64_t{1} << 59;
// In a root's cell that pages cannot span, the longest side of a triangle's box, in steps: the nodes that own
// triangles lie below those of the coarsest level (common/dataset/hierarchy.hpp).
inline constexpr std::uint64_t kMostTriangleSteps = std::uint64_t{1} << 27;

// The lattice of a dataset and the cube on it that holds everything.
struct Lattice {
    int stepExponent = 0;            // one step is 2^stepExponent model units
    LatticePoint rootCell{0, 0, 0};  // lowest corner
    unsigned rootCellLog2 = 0;       // edge: 2^rootCellLog2 steps, at most 2^61

    LatticePoint fromCell(const CellPoint& p) const {
        return rootCell + LatticePoint(static_cast<std::int64_t>(p.x), static_cast<std::int64_t>(p.y),
                                       static_cast<std::int64_t>(p.z));
    }
};

// What decides where in the octree a triangle belongs.
struct TrianglePlace {
    CellPoint centroid;
    unsigned depth;  // the deepest whose cells are as large as the triangle's box
};

inline TrianglePlace placeOf(const CellPoint& a, const CellPoint& b, const CellPoint& c,
                             unsigned rootCellLog2) {
    std::uint64_t longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax({a[axis], b[axis], c[axis]});
        longest = std::max(longest, high - low);
    }
    // The smallest e with 2^e >= longest; never 0 sized, as its corners are distinct.
    const unsigned edgeLog2 = static_cast<unsigned>(std::bit_width(longest - 1));
    return {CellPoint((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3),
            rootCellLog2 - edgeLog2};
}

}  // namespace iwalk
