#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/page.hpp"
#include "preprocess/build/record.hpp"

namespace iwalk {

// Sorted triangles of one node, or a part of them.
struct Slice {
    std::uint32_t node = 0;  // in the Tree
    unsigned edgeLog2 = 0;   // of the node's cell
    LatticeBox box;          // of the triangles that came with it, those of other slices included
    const std::uint32_t* records = nullptr;
    const std::uint32_t* order = nullptr;  // numbers of records; nullptr: as they lie
    std::size_t count = 0;                 // triangles
    std::vector<std::uint32_t> owned;      // keeps `records` when they are the slice's own

    const std::uint32_t* record(std::size_t i, std::size_t words) const {
        return records + (order != nullptr ? order[i] : i) * words;
    }
};

// What is to become one page: slices of one node lie side by side, in order.
struct PageJob {
    std::vector<Slice> slices;
};

// Which ranges of the page are whose.
struct NodeRanges {
    std::uint32_t node;
    std::uint32_t firstRange, rangeCount;
};

struct BuiltPage {
    std::vector<std::byte> bytes;
    PageRecord record{};
    std::vector<NodeRanges> nodes;
};

inline constexpr std::size_t kMaxPageTriangles =
    kMaxPageVertices / 3;  // that many fit even if no vertex is shared

// Welds, cuts into ranges, optimises and encodes. Depends on the job alone.
BuiltPage buildPage(const PageJob& job, const Lattice& lattice, const RecordFormat& format,
                    std::uint32_t attributes);

}  // namespace iwalk
