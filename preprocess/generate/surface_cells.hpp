#pragma once

#include <array>
#include <cstdint>

#include "preprocess/generate/crossed_edges.hpp"
#include "preprocess/generate/cube_table.hpp"

namespace iwalk {

// Calls f(y, z, inside) for every cell between two slabs that the surface crosses; `inside` has the cell's
// corners as cube_table.hpp numbers them.
template <class F>
void forCrossedCells(const IsosurfaceGrid& grid, const Signs& a, const Signs& b, F&& f) {
    for (std::size_t z = 0; z < grid.layers; ++z) {
        const std::array rows{rowOf(grid, a, z), rowOf(grid, b, z), rowOf(grid, a, z + 1),
                              rowOf(grid, b, z + 1)};
        for (std::size_t word = 0; word < grid.words(); ++word) {
            std::array<std::uint64_t, 8> corners{};
            std::uint64_t any = 0, all = ~std::uint64_t{0};
            for (std::size_t i = 0; i < 8; ++i) {
                const auto row = rows[(i & 1) | (i >> 2) << 1];
                corners[i] = (i & 2) == 0 ? row[word] : following(row, word);
                any |= corners[i], all &= corners[i];
            }
            for (std::uint64_t crossed = any & ~all & grid.edges(word); crossed != 0;
                 crossed &= crossed - 1) {
                const auto bit = static_cast<unsigned>(std::countr_zero(crossed));
                unsigned inside = 0;
                for (unsigned i = 0; i < 8; ++i) inside |= static_cast<unsigned>(corners[i] >> bit & 1) << i;
                f(word * 64 + bit, z, inside);
            }
        }
    }
}

}  // namespace iwalk
