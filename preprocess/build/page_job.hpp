#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/page.hpp"
#include "preprocess/build/order.hpp"
#include "preprocess/build/record.hpp"

namespace iwalk {

// Triangles that make one range.
struct Run {
    std::size_t end = 0;     // it begins where the run before ends
    std::uint32_t path = 1;  // of its cell
    LatticeBox box;          // of all that the cell has in finer levels
};

// Sorted triangles of one node, or a part of them.
struct Slice {
    std::uint32_t node = 0;  // in the Tree
    unsigned edgeLog2 = 0;   // of the node's cell
    LatticeBox box;          // of the triangles that came with it, those of other slices included
    const std::uint32_t* records = nullptr;
    const std::uint32_t* order = nullptr;  // numbers of records; nullptr: as they lie
    std::size_t count = 0;                 // triangles
    std::vector<std::uint32_t> owned;      // keeps `records` when they are the slice's own
    std::vector<Run> runs;                 // of a coarser level; empty: to be cut by the triangles' places
    unsigned leastLevels = 0;              // of cells below the node's: cutRanges()
    int group = 0;                         // only slices of one group may share a page

    const std::uint32_t* record(std::size_t i, std::size_t words) const {
        return records + (order != nullptr ? order[i] : i) * words;
    }
};

// What is to become one page: slices of one node lie side by side, in order.
struct PageJob {
    std::vector<Slice> slices;
    KeysAround around;  // when it is a part of a node with several pages
};

// What of the page is whose.
struct NodeRanges {
    std::uint32_t node;
    std::uint32_t firstRange, rangeCount;
    std::uint32_t triangles, vertices;  // vertices that several nodes use count for each
    LatticeBox box;                     // of the ranges
    std::uint8_t error;                 // largest of the vertices', in 255ths of the level's limit
};

struct BuiltPage {
    std::vector<std::byte> bytes;
    PageRecord record{};
    std::vector<NodeRanges> nodes;
    std::vector<std::uint8_t> errors;  // by vertex, in 255ths of the level's limit; empty at full resolution
};

inline constexpr std::size_t kMaxPageTriangles =
    kMaxPageVertices / 3;  // that many fit even if no vertex is shared

// Welds, cuts into ranges, optimises and encodes. Depends on the job alone.
BuiltPage buildPage(const PageJob& job, const Lattice& lattice, const RecordFormat& format,
                    std::uint32_t attributes);

}  // namespace iwalk
