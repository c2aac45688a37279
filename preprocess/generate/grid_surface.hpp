#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "preprocess/generate/ply_output.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

// A rectangle of cells, two triangles each.
struct CellGrid {
    std::uint32_t columns = 0, rows = 0;

    // The one with the number of triangles next to the one wanted, among those that are nearly squares.
    static CellGrid ofTriangles(std::uint64_t triangles) {
        const std::uint64_t cells = triangles / 2;
        const auto middle = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(cells)));
        CellGrid best{middle, middle};
        const auto miss = [&](const CellGrid& grid) {
            return std::abs(static_cast<std::int64_t>(std::uint64_t{grid.columns} * grid.rows) -
                            static_cast<std::int64_t>(cells));
        };
        for (std::uint32_t columns = middle - 3; columns <= middle + 3; ++columns) {
            const CellGrid grid{columns, static_cast<std::uint32_t>((cells + columns / 2) / columns)};
            if (miss(grid) < miss(best)) best = grid;
        }
        return best;
    }
};

// All of a grid's vertices, row by row: `vertex(column, row)` writes one. Row and column 0 to their numbers.
template <class Vertex>
Result<void> writeGridVertices(const CellGrid& grid, PlyOutput& output, Progress& progress,
                               const Vertex& vertex) {
    progress.phase("vertices");
    for (std::uint32_t row = 0; row <= grid.rows; ++row) {
        for (std::uint32_t column = 0; column <= grid.columns; ++column) vertex(column, row);
        RETURN_IF_ERROR(output.status());
        progress.done(static_cast<double>(row) / grid.rows);
    }
    return {};
}

// All of a grid's triangles, counter-clockwise where columns go right and rows go up. `first`: the number of
// its first vertex.
inline Result<void> writeGridTriangles(const CellGrid& grid, PlyOutput& output, Progress& progress,
                                       std::uint32_t first = 0) {
    progress.phase("triangles");
    for (std::uint32_t row = 0; row < grid.rows; ++row) {
        for (std::uint32_t column = 0; column < grid.columns; ++column) {
            const std::uint32_t low = first + row * (grid.columns + 1) + column;
            const std::uint32_t high = low + grid.columns + 1;
            output.triangle(low, low + 1, high + 1);
            output.triangle(low, high + 1, high);
        }
        RETURN_IF_ERROR(output.status());
        progress.done(static_cast<double>(row) / grid.rows);
    }
    return {};
}

}  // namespace iwalk
