#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "preprocess/build/record.hpp"

namespace iwalk {

// Sorts `order`, numbers of records in `records`, by sortKey() for a cell of edge 2^edgeLog2; stable.
void sortByKey(const RecordFormat& format, const std::uint32_t* records, unsigned edgeLog2,
               std::span<std::uint32_t> order);

inline constexpr std::size_t kMaxRangeTriangles = 512;
// Ranges of level l are of cells at depth l + kRangeLevels or deeper where they have more triangles than
// this: lower it, and boxes are smaller beside the level's error, and more.
inline constexpr std::size_t kFewTriangles = 256;
inline constexpr unsigned kRangeLevels = 1;

// Whether a cell so many levels below its node's must be split. What is split in one level is split in all
// finer ones, since these have no fewer triangles: so every range lies in one of the next coarser level.
inline bool isTooLarge(std::size_t triangles, unsigned levels, unsigned leastLevels) {
    return triangles > kMaxRangeTriangles || (triangles > kFewTriangles && levels < leastLevels);
}

// A run of triangles that are all that one cell has.
struct CellRun {
    std::size_t end;     // it begins where the run before ends
    std::uint32_t path;  // of the cell, below the node's (common/dataset/page.hpp)
    bool operator==(const CellRun&) const = default;
};

// Keys of the same node's triangles on the pages before and after.
struct KeysAround {
    std::optional<std::uint64_t> before = std::nullopt, after = std::nullopt;
};

// Cuts triangles with these ascending keys, in a node of edge 2^edgeLog2, into runs of at most
// kMaxRangeTriangles: of each the deepest cell that holds it, which has no other triangles. Only where paths
// end, a cell may have several runs, on several pages too. Cells less than `leastLevels` below the node's are
// split unless they have few triangles.
std::vector<CellRun> cutRanges(std::span<const std::uint64_t> keys, unsigned edgeLog2,
                               unsigned leastLevels = 0, const KeysAround& around = {});

}  // namespace iwalk
