#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/build/record.hpp"

namespace iwalk {

// Sorts `order`, numbers of records in `records`, by sortKey() for a cell of edge 2^edgeLog2; stable.
void sortByKey(const RecordFormat& format, const std::uint32_t* records, unsigned edgeLog2,
               std::span<std::uint32_t> order);

inline constexpr std::size_t kMaxRangeTriangles = 512;

// Cuts triangles with these ascending keys into runs of at most kMaxRangeTriangles: at the borders of the
// largest cells that need it, then joins neighbours while they fit. Returns the ends of the runs.
std::vector<std::size_t> cutRanges(std::span<const std::uint64_t> keys);

}  // namespace iwalk
