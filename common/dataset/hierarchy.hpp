#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "common/dataset/manifest.hpp"
#include "common/geometry.hpp"
#include "common/result.hpp"

namespace iwalk {

static_assert(std::endian::native == std::endian::little, "iWalk's files are read and written in place");

// Lattice coordinates in a dataset are within +-kLatticeLimit, so that differences of them cannot overflow.
inline constexpr std::int64_t kLatticeLimit = std::int64_t{1} << 61;

// One node of the octree as it is on disk and in memory. Children lie in a row, in Morton order of their
// octants (x is bit 0); a parent precedes its children, and node 0 is the root. Triangles belong to the
// deepest node on their centroid's way down whose cell is as large as they are, so interior nodes may own
// some too.
struct NodeRecord {
    std::int64_t boxMin[3], boxMax[3];  // lattice, inclusive: content of the node and all below it
    std::int64_t ownMin[3], ownMax[3];  // lattice, inclusive: the node's own triangles; min > max when none
    std::uint64_t triangles;            // own
    std::uint32_t firstChild;           // index of the first child; unused for a leaf
    std::uint32_t firstPage;            // own triangles: pages [firstPage, firstPage + pageCount)
    std::uint32_t pageCount;            // 0 when it owns none
    std::uint16_t firstRange;  // when pageCount is 1: ranges [firstRange, firstRange + rangeCount) of that
    std::uint16_t rangeCount;  // page; with more pages all of their ranges, and this is 0
    std::uint8_t childMask;    // bit o set: there is a child in octant o; 0: a leaf
    std::uint8_t depth;        // 0 for the root
    std::uint8_t reserved[6];  // 0
};
static_assert(sizeof(NodeRecord) == 128);

// Which streams a page has, beside indices; and how positions are packed.
enum PageFlags : std::uint32_t {
    kPageWide = 1,     // positions as 3 x 32 bits (12 bytes); without it 3 x 21 bits in 8 bytes
    kPageColors = 2,   // RGBA8, sRGB
    kPageNormals = 4,  // octahedral, 2 x snorm16
};

// Where a page is and what it will need, known without reading it.
struct PageRecord {
    std::uint64_t offset;  // bytes into its file
    std::uint32_t file;    // index into Manifest::pageFiles
    std::uint32_t bytes;   // on disk
    std::uint32_t vertexCount, indexCount, rangeCount;
    std::uint32_t flags;  // PageFlags
};
static_assert(sizeof(PageRecord) == 32);

// The octree's skeleton (HS): always in memory; grows with nodes and pages, not with triangles.
struct Hierarchy {
    LatticePoint rootCell{0, 0, 0};  // lowest corner of the root's cell, lattice
    std::uint32_t rootCellLog2 = 0;  // edge of the root's cell: 2^rootCellLog2 steps
    std::vector<NodeRecord> nodes;   // at least the root
    std::vector<PageRecord> pages;

    // Child c (c-th set bit of childMask) is node firstChild + c.
    static int childCount(const NodeRecord& node) { return std::popcount(unsigned{node.childMask}); }
    static LatticeBox box(const NodeRecord& node);
    static LatticeBox ownBox(const NodeRecord& node);
};

// Reads DATASET's hierarchy and checks everything that later code relies on: checksum, indices in range,
// every node and page reached once, counts and boxes consistent, page places inside their files.
Result<Hierarchy> loadHierarchy(const std::string& dataset, const Manifest& manifest);

// Writes and fsyncs `path`; the result is its size in bytes.
Result<std::uint64_t> saveHierarchy(const std::string& path, const Hierarchy& hierarchy);

}  // namespace iwalk
