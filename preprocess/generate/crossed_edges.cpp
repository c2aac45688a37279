#include "preprocess/generate/crossed_edges.hpp"

#include <array>
#include <cstring>

namespace iwalk {
namespace {

// The lowest bits of eight bytes that are 0 or 1, the first one's lowest.
std::uint64_t gather(const std::uint8_t* bytes) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, bytes, 8);
    return eight * 0x0102040810204080u >> 56;
}

std::uint64_t negative(const float* values) {
    std::array<std::uint8_t, 64> flags;
    for (std::size_t i = 0; i < 64; ++i) flags[i] = values[i] < 0 ? 1 : 0;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < 64; i += 8) bits |= gather(&flags[i]) << i;
    return bits;
}

}  // namespace

void findSigns(const IsosurfaceGrid& grid, std::span<const float> values, Signs& signs) {
    signs.resize(grid.rows() * grid.words());
    for (std::size_t i = 0; i < signs.size(); ++i) signs[i] = negative(&values[i * 64]);
}

std::uint32_t findSlabEdges(const IsosurfaceGrid& grid, const Signs& signs, SlabEdges& edges,
                            std::uint32_t next) {
    for (std::size_t z = 0; z < grid.rows(); ++z) {
        const auto row = rowOf(grid, signs, z), higher = rowOf(grid, signs, z < grid.layers ? z + 1 : z);
        for (std::size_t word = 0; word < grid.words(); ++word) {
            next = edges.y.set(z, word, (row[word] ^ following(row, word)) & grid.edges(word), next);
            next = edges.z.set(z, word, (row[word] ^ higher[word]) & grid.points(word), next);
        }
    }
    return next;
}

std::uint32_t findEdgesBetween(const IsosurfaceGrid& grid, const Signs& a, const Signs& b,
                               CrossedEdges& edges, std::uint32_t next) {
    for (std::size_t z = 0; z < grid.rows(); ++z) {
        const auto from = rowOf(grid, a, z), to = rowOf(grid, b, z);
        for (std::size_t word = 0; word < grid.words(); ++word) {
            next = edges.set(z, word, (from[word] ^ to[word]) & grid.points(word), next);
        }
    }
    return next;
}

}  // namespace iwalk
