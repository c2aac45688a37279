#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/dataset/manifest.hpp"
#include "common/dataset/opacity.hpp"
#include "common/geometry.hpp"
#include "common/result.hpp"

namespace iwalk {

static_assert(std::endian::native == std::endian::little, "iWalk's files are read and written in place");

// Lattice coordinates in a dataset are within +-kLatticeLimit, so that differences of them cannot overflow.
inline constexpr std::int64_t kLatticeLimit = std::int64_t{1} << 61;

// Levels number the resolutions of the whole model from coarse (0) to fine; this one is the input's own.
inline constexpr std::uint8_t kFullLevel = 255;

// e_level, the most that the surface at a level may lie away from the input: lattice steps. The root's cell
// measures 64 e_0, and a cell at depth d 64 e_d.
inline double levelErrorSteps(unsigned rootCellLog2, unsigned level) {
    return std::ldexp(1.0, static_cast<int>(rootCellLog2) - 6 - static_cast<int>(level));
}

// Offsets in pages have 32 bits. In a root's cell of more steps than that levels begin where cells have 2^28:
// the nodes above, few as a rule, have no entries, and no node above that depth is a leaf.
inline constexpr unsigned kMostWholeLog2 = 32, kCoarsestCellLog2 = 28;
inline unsigned coarsestLevel(unsigned rootCellLog2) {
    return rootCellLog2 > kMostWholeLog2 ? rootCellLog2 - kCoarsestCellLog2 : 0;
}

// An entry of a node: the geometry it has at one level. An interior node of depth d has level d of everything
// in it and below it first; what follows are its own triangles alone, at levels d + 1 to f and full. A leaf
// has its triangles at levels d to f and full. f is the node's own, at least d - 1: nothing but full.
struct LevelRecord {
    std::uint32_t firstPage, pageCount;  // pages [firstPage, firstPage + pageCount), at least one
    std::uint32_t triangles, vertices;   // of the entry; vertices: those of pages that its triangles use
    float error;                         // lattice steps: bound of the distance to full; at most e_level
    std::uint16_t firstRange;            // when pageCount is 1: ranges [firstRange, firstRange + rangeCount)
    std::uint16_t rangeCount;            // of that page; with more pages all of their ranges, and this is 0
    std::uint8_t level;                  // or kFullLevel
    std::uint8_t reserved[7];            // 0
};
static_assert(sizeof(LevelRecord) == 32);

// One node of the octree as it is on disk and in memory. Children lie in a row, in Morton order of their
// octants (x is bit 0); a parent precedes its children, and node 0 is the root. Triangles belong to the
// deepest node on their centroid's way down whose cell is as large as they are, so interior nodes may own
// some too.
struct NodeRecord {
    // Lattice, inclusive. Around all levels of the node and everything below it, and the places that vertices
    // move to on their way to the next coarser level.
    std::int64_t boxMin[3], boxMax[3];
    // Around the own triangles at all levels that the node has them at by themselves; min > max when none.
    std::int64_t ownMin[3], ownMax[3];
    std::uint32_t firstChild;  // index of the first child; 0 in a leaf
    std::uint32_t firstEntry;  // entries [firstEntry, firstEntry + entryCount), from coarse to fine
    std::uint8_t entryCount;
    std::uint8_t childMask;                    // bit o set: there is a child in octant o; 0: a leaf
    std::uint8_t depth;                        // 0 for the root
    std::uint8_t reserved;                     // 0
    std::uint8_t opacity[kOpacityDirections];  // of a leaf, 0 to 255 for 0 to 1; 0 in interior nodes
};
static_assert(sizeof(NodeRecord) == 128);

// Which streams a page has, beside indices; and how positions are packed.
enum PageFlags : std::uint32_t {
    kPageWide = 1,     // positions as 3 x 32 bits (12 bytes); without it 3 x 21 bits in 8 bytes
    kPageColors = 2,   // RGBA8, sRGB
    kPageNormals = 4,  // octahedral, 2 x snorm16
    kMorphWide = 8,    // as kPageWide, of the page's morph block; in its page record only
};

// Where a page and its morph block are and what they will need, known without reading them.
struct PageRecord {
    std::uint64_t offset;       // bytes into its file
    std::uint64_t morphOffset;  // bytes into the morph block's file
    std::uint32_t bytes;        // on disk
    std::uint32_t morphBytes;   // on disk; 0: the page has no morph block
    std::uint32_t vertexCount, indexCount, rangeCount;
    std::uint16_t file, morphFile;  // indices into Manifest::pageFiles
    std::uint32_t flags;            // PageFlags
    std::uint32_t reserved;         // 0
};
static_assert(sizeof(PageRecord) == 48);

// The octree's skeleton (HS): always in memory; grows with nodes and pages, not with triangles.
struct Hierarchy {
    LatticePoint rootCell{0, 0, 0};    // lowest corner of the root's cell, lattice
    std::uint32_t rootCellLog2 = 0;    // edge of the root's cell: 2^rootCellLog2 steps
    std::vector<NodeRecord> nodes;     // at least the root
    std::vector<LevelRecord> entries;  // node by node
    std::vector<PageRecord> pages;

    // Child c (c-th set bit of childMask) is node firstChild + c.
    static int childCount(const NodeRecord& node) { return std::popcount(unsigned{node.childMask}); }
    static bool isLeaf(const NodeRecord& node) { return node.childMask == 0; }
    static LatticeBox box(const NodeRecord& node);
    static LatticeBox ownBox(const NodeRecord& node);

    // False where every entry is full: such a dataset can be drawn at full resolution only.
    bool hasLevels() const { return !entries.empty() && entries[0].level != kFullLevel; }
    std::span<const LevelRecord> entriesOf(const NodeRecord& node) const {
        return std::span(entries).subspan(node.firstEntry, node.entryCount);
    }
    // nullptr when the node has no such entry.
    const LevelRecord* entryAt(const NodeRecord& node, unsigned level) const;
    const LevelRecord* fullEntryOf(const NodeRecord& node) const { return entryAt(node, kFullLevel); }
    std::uint32_t ownTriangles(const NodeRecord& node) const;  // of the input
    // Whether the entry is of everything below the node too, and not of its own triangles alone.
    static bool isWhole(const NodeRecord& node, const LevelRecord& entry) {
        return !isLeaf(node) && entry.level == node.depth;
    }
    // The box that contains the entry: isWhole() decides which of the node's.
    static LatticeBox entryBox(const NodeRecord& node, const LevelRecord& entry) {
        return isWhole(node, entry) ? box(node) : ownBox(node);
    }
    // What of this node is drawn when all of the model is drawn at one level, and no finer than it has; with
    // kFullLevel (or a level finer than all) the input. nullptr: nothing.
    const LevelRecord* drawnAt(const NodeRecord& node, unsigned level) const;
};

// The lowest corners of the nodes' cells, lattice.
std::vector<LatticePoint> cellsOfNodes(const Hierarchy& hierarchy);

// Reads DATASET's hierarchy and checks everything that later code relies on: checksum, indices in range,
// every node, entry, page and range reached once, counts, levels, errors and boxes consistent, pages and
// morph blocks inside their files.
Result<Hierarchy> loadHierarchy(const std::string& dataset, const Manifest& manifest);

// Writes and fsyncs `path`; the result is its size in bytes.
Result<std::uint64_t> saveHierarchy(const std::string& path, const Hierarchy& hierarchy);

}  // namespace iwalk
