#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/levels/page_store.hpp"
#include "preprocess/levels/stage.hpp"

namespace iwalk {

// Where a vertex of a page goes in the next coarser level.
struct VertexTarget {
    std::uint32_t stagePage = 0, vertex = 0;
    float error = 0;  // steps; of the point it goes to
    std::uint32_t color = 0, normal = 0;
    CellPoint position{0};
};

struct CellDecision {
    std::vector<VertexTarget> targets;  // of a vertex that stays as it is nothing is said
    std::vector<std::uint32_t>
        moved;  // stage pages that are not fresh, with vertices that went elsewhere before
};

// Decides where the vertices in `cell` go. `touching`: the stage pages whose boxes meet the cell. A vertex
// that triangles with vertices elsewhere use stays: what other cells see of it does not change. So does one
// that pages held use. A cell with more than `mostTriangles`, or so many points, is decided in halves, or,
// when most of them reach out of it, not at all.
Result<CellDecision> decideCell(const SpaceCell& cell, const Stage& stage,
                                std::span<const std::uint32_t> touching, PageStore& store,
                                std::size_t mostTriangles);

}  // namespace iwalk
