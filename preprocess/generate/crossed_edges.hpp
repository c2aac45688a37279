#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/generate/isosurface_grid.hpp"

namespace iwalk {

// Where the field is negative at the points of a slab: a bit for each, [rows()][words()].
using Signs = std::vector<std::uint64_t>;

// `values`: [rows()][stride()].
void findSigns(const IsosurfaceGrid& grid, std::span<const float> values, Signs& signs);

inline std::span<const std::uint64_t> rowOf(const IsosurfaceGrid& grid, const Signs& signs, std::size_t z) {
    return std::span(signs).subspan(z * grid.words(), grid.words());
}
// The word whose bit i is bit i + 1 of a row, counted from word `word` on.
inline std::uint64_t following(std::span<const std::uint64_t> row, std::size_t word) {
    return row[word] >> 1 | (word + 1 < row.size() ? row[word + 1] << 63 : 0);
}

// The number of bits that are set. In line and without tables: half the time of std::popcount where it is a
// call.
inline std::uint32_t bitsIn(std::uint64_t word) {
    word -= word >> 1 & 0x5555555555555555u;
    word = (word & 0x3333333333333333u) + (word >> 2 & 0x3333333333333333u);
    word = (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0fu;
    return static_cast<std::uint32_t>(word * 0x0101010101010101u >> 56);
}

// The edges of the grid in one direction that start at the points of a slab and cross the surface. On each is
// a vertex; its number is found by counting bits, so that no table of vertices is needed.
class CrossedEdges {
  public:
    explicit CrossedEdges(const IsosurfaceGrid& grid)
        : words_(grid.words()), crossed_(grid.rows() * words_), first_(crossed_.size()) {}

    std::uint64_t crossed(std::size_t row, std::size_t word) const { return crossed_[row * words_ + word]; }
    // Sets the bits of a word and numbers their vertices from `next` on; the next number comes back.
    std::uint32_t set(std::size_t row, std::size_t word, std::uint64_t crossed, std::uint32_t next) {
        crossed_[row * words_ + word] = crossed;
        first_[row * words_ + word] = next;
        return next + bitsIn(crossed);
    }
    // Of the edge that starts at point y of the row, which must be crossed.
    std::uint32_t vertex(std::size_t row, std::size_t y) const {
        const std::size_t word = row * words_ + y / 64;
        const std::uint64_t before = crossed_[word] & ((std::uint64_t{1} << (y % 64)) - 1);
        return first_[word] + bitsIn(before);
    }

  private:
    std::size_t words_;
    std::vector<std::uint64_t> crossed_;
    std::vector<std::uint32_t> first_;  // vertex
};

// The edges within a slab: those along y and those along z.
struct SlabEdges {
    explicit SlabEdges(const IsosurfaceGrid& grid) : y(grid), z(grid) {}
    CrossedEdges y, z;
};

// Finds and numbers the edges from vertex `next` on; the next number comes back. Order: row by row, word by
// word, edges along y before those along z.
std::uint32_t findSlabEdges(const IsosurfaceGrid& grid, const Signs& signs, SlabEdges& edges,
                            std::uint32_t next);
// The same for the edges along x, from the slab with signs `a` to the one with signs `b`.
std::uint32_t findEdgesBetween(const IsosurfaceGrid& grid, const Signs& a, const Signs& b,
                               CrossedEdges& edges, std::uint32_t next);

}  // namespace iwalk
