#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/build/lattice.hpp"
#include "preprocess/build/old_tree.hpp"

// Triangles are sorted into the octree three levels at a time, on disk and in memory alike. A grid is a node
// of the octree and all that is up to three levels below; its bins are these 585 cells in depth-first
// preorder, so that everything below a cell is one run of bins. A triangle goes into the bin of the deepest
// of these cells on its centroid's way that is as large as the triangle.
namespace iwalk {

inline constexpr unsigned kGridLevels = 3;
inline constexpr std::size_t kGridBins = 1 + 8 + 64 + 512;
// Bins in a cell, by its level in the grid.
inline constexpr std::array<std::size_t, kGridLevels + 1> kBinsBelow{585, 73, 9, 1};

// Bits 0..20 of x, y, z interleaved; x lowest.
std::uint64_t morton(const CellPoint& p);

// The bin of a triangle in the grid below the node of depth `base` that its centroid lies in; place.depth >=
// base.
std::size_t binOf(const TrianglePlace& place, unsigned base, unsigned rootCellLog2);

// The order of triangles in a node whose cells have edge 2^edgeLog2: Morton order of the centroid in the
// cell, in 48 bits, then large ones first. Triangles with equal keys stay in the order of the input.
inline constexpr unsigned kMortonKeyBits = 48;
inline constexpr unsigned kKeyBits = kMortonKeyBits + 6;
std::uint64_t sortKey(const TrianglePlace& place, unsigned edgeLog2);

// A cell of a grid that is to become a node, or several.
struct PlannedNode {
    enum Kind : std::uint8_t {
        kLeaf,      // a leaf with all triangles of its bins
        kInterior,  // a node with the triangles of its one bin; children may follow
        kSubtree,   // at the bottom of the grid and still too much for a leaf: a grid of its own
        kKept,      // a node of the old tree that nothing touches, with all below it
    };
    Kind kind;
    std::uint8_t level, octant;  // in the grid; in its parent (of a grid's root: 0, unused)
    std::uint32_t parent;        // index in the plan, or kNoParent
    std::size_t firstBin, binCount;
    std::uint32_t old;  // the node of the old tree that it is, or OldTree::kNone
};
inline constexpr std::uint32_t kNoParent = 0xffffffff;

// Splits what has more than `leafTriangles` triangles, in depth-first order, from the counts of the bins
// alone, and what the old tree splits. `old`: the node of the old tree in the place of the grid's root.
// `noLeaves`: so many of the topmost levels of the grid have no leaves, whatever their counts.
std::vector<PlannedNode> planGrid(std::span<const std::uint64_t> binCounts, std::uint64_t leafTriangles,
                                  const OldTree& tree, std::uint32_t old, unsigned noLeaves = 0);

// The same for the grid whose root is at this depth.
inline unsigned levelsWithoutLeaves(unsigned depth, unsigned rootCellLog2) {
    const unsigned coarsest = coarsestLevel(rootCellLog2);
    return coarsest > depth ? coarsest - depth : 0;
}

}  // namespace iwalk
