#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "preprocess/build/lattice.hpp"

namespace iwalk {

// A box of space, [low, high) in steps from the root cell's corner: what one cell of a partition decides
// about.
struct SpaceCell {
    CellPoint low{0}, high{0};

    bool contains(const CellPoint& p) const {
        return p.x >= low.x && p.x < high.x && p.y >= low.y && p.y < high.y && p.z >= low.z && p.z < high.z;
    }
    // Of the box [low, high], ends included.
    bool meets(const CellPoint& boxLow, const CellPoint& boxHigh) const {
        bool meets = true;
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            meets = meets && boxLow[axis] < high[axis] && boxHigh[axis] >= low[axis];
        }
        return meets;
    }
};

// A cell of a partition, [low, high): lattice.
struct LatticeCell {
    LatticePoint low{0, 0, 0}, high{0, 0, 0};
    bool operator==(const LatticeCell&) const = default;
};

// Triangles somewhere in a cube (lattice; edge in steps): what partitions are made from.
struct Weight {
    LatticePoint low{0, 0, 0};
    std::uint64_t edge = 0;
    std::uint64_t triangles = 0;
};

// How large cells may be. Edges are in steps.
struct CellSizes {
    std::uint64_t mostTriangles;  // about; but for what `leastEdge` forbids to split
    std::uint64_t leastEdge;
    std::uint64_t mostEdge;  // of a cell with triangles
};

// Cuts space into cells by an octree of its own: its planes lie elsewhere for each level, so that what is
// held at a border of one level is free in the next. Where they lie depends on the level's error alone,
// 2^errorLog2 steps, and not on the root's cell: when the root grows, cells stay what they were, and more
// triangles change only those that they lie in. Cells come in Morton order and cover all of the lattice.
// Depends on the weights alone.
std::vector<LatticeCell> cutCells(std::span<const Weight> weights, int errorLog2, const CellSizes& sizes);

// What of the cell lies in the root's, outside of which there is nothing.
std::optional<SpaceCell> inRoot(const LatticeCell& cell, const Lattice& lattice);

}  // namespace iwalk
