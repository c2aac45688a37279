#pragma once

#include <cstdint>
#include <span>

namespace iwalk::levels {

// Edges that are passed more often one way than the other: 0 in a closed surface whose triangles are oriented
// alike. `corners`: three a triangle; equal numbers are one place, and edges from a place to itself do not
// count. A closed surface is recognised by a sum of hashes, wrongly once in 2^64 cases.
std::uint64_t openEdges(std::span<const std::uint32_t> corners);

}  // namespace iwalk::levels
