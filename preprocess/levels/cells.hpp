#pragma once

#include <cstdint>
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
};

// Triangles somewhere in a box (steps from the root cell's corner): what partitions are made from.
struct Weight {
    CellPoint low{0};
    std::uint64_t edge = 0;
    std::uint64_t triangles = 0;
};

// Cuts the root's cell into cells with about `mostTriangles` triangles or less, not smaller than `leastEdge`
// steps, by an octree of its own: its planes lie elsewhere for each `level`, so that what is held at a border
// of one level is free in the next. Cells come in Morton order and cover everything; those without weight may
// be left out where nothing lies. Depends on the weights alone.
std::vector<SpaceCell> cutCells(std::span<const Weight> weights, unsigned rootCellLog2, unsigned level,
                                std::uint64_t mostTriangles, std::uint64_t leastEdge);

}  // namespace iwalk
