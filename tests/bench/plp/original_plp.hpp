#pragma once

#include <cstdint>
#include <vector>

#include "server/visibility/entry_priority.hpp"

namespace iwalk::bench {

// Prioritized-layered projection as it was before rays (Klosowski and Silva, as Correa 2004, section 4.2,
// has it), to compare with: the leaves of the octree, empty ones too, are neighbours where they share a face.
// From the leaf nearest to the eye a front grows: the leaf of the highest priority is projected, and its
// neighbours join the front with what its solidity, its share of the triangles a leaf may have, leaves of its
// priority.
//
// The paper's weights are not all given. Here solidity counts by the cosine between the view and the shared
// face's normal, and going back towards the eye halves the priority. An interior node's own triangles are
// taken with the first leaf below it.
class OriginalPlp {
  public:
    // References are kept. `leafTriangles`: Manifest::leafTriangles.
    OriginalPlp(const Hierarchy& hierarchy, const Cut& cut, std::uint64_t leafTriangles);

    // Indices of the cut's entries in the order in which they are projected, until they have at least
    // `budget` triangles.
    std::vector<std::uint32_t> project(const TileSight& sight, std::uint64_t budget) const;

  private:
    static constexpr std::uint32_t kNobody = 0xffffffff;
    struct Neighbour {
        std::uint32_t cell;
        int axis, side;  // the shared face's normal towards it: `side` (1 or -1) along `axis`
    };
    struct Cell {
        LatticePoint corner;
        unsigned depth;
        std::uint32_t node;  // kNobody: nothing is in it
        std::uint32_t children[8];
        bool leaf;
        std::vector<Neighbour> neighbours;
    };

    std::uint32_t addCell(const LatticePoint& corner, unsigned depth, std::uint32_t node);
    void linkInside(std::uint32_t cell);
    void linkAcross(std::uint32_t low, std::uint32_t high, int axis);
    double solidity(const Cell& cell) const;
    LatticeBox boxOf(const Cell& cell) const;
    std::uint32_t nearestCell(const Frustum& frustum, const LatticeEye& eye) const;

    const Hierarchy& hierarchy_;
    const Cut& cut_;
    const double leafTriangles_;
    std::vector<std::uint32_t> parents_;  // by node
    std::vector<Cell> cells_;
};

}  // namespace iwalk::bench
