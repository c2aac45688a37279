#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/dataset/hierarchy.hpp"
#include "preprocess/build/record.hpp"
#include "preprocess/build/tree.hpp"

namespace iwalk {

class OldTree;

// Where triangles of an entry come from: an entry of the next finer level.
struct EntrySource {
    LevelRecord entry;
    std::uint64_t way;  // from the node that the entry is made for to the source's: octants, 3 bits each
    unsigned wayLevels;
    bool held;  // its triangles stay as they are
};

// The octree while its levels are made, from fine to coarse.
struct LevelModel {
    Lattice lattice;
    std::vector<NodeRecord> nodes;  // breadth first
    std::vector<int> finest;        // by node: finest level of its own triangles, at least depth - 1
    std::vector<std::vector<LevelRecord>> entries;  // by node, full first, then from fine to coarse
    std::vector<std::uint32_t>
        origin;  // by node: that of the dataset inserted into that it is, or Tree::kNone

    bool owns(std::uint32_t node) const {
        return !entries[node].empty() && entries[node].front().level == kFullLevel;
    }
    bool isLeaf(std::uint32_t node) const { return nodes[node].childMask == 0; }
    unsigned depth(std::uint32_t node) const { return nodes[node].depth; }
    // Whether the node gets an entry of everything below it, or of its own triangles by themselves, at
    // `level`.
    bool hasWhole(std::uint32_t node, unsigned level) const { return !isLeaf(node) && depth(node) == level; }
    bool hasOwn(std::uint32_t node, unsigned level) const {
        return owns(node) && finest[node] >= static_cast<int>(level) &&
               (isLeaf(node) ? depth(node) <= level : depth(node) < level);
    }
    // Whether the node's own triangles are at full resolution when the rest is at `level`, and by themselves.
    bool fullAt(std::uint32_t node, unsigned level) const {
        return owns(node) && finest[node] < static_cast<int>(level) &&
               (isLeaf(node) ? depth(node) <= level : depth(node) < level);
    }
    // Of the node's triangles, with those below it or by themselves; there is one.
    const LevelRecord& entryAt(std::uint32_t node, unsigned level) const;
    // What the pass that makes `level` makes the node's whole or own entry of.
    std::vector<EntrySource> sourcesOf(std::uint32_t node, unsigned level) const;
    // The finest level that is to be made; -1: none.
    int finestLevel() const;
    // A node before its children, these by octant.
    std::vector<std::uint32_t> depthFirst() const;
    // The lowest corners of the nodes' cells, in steps from the root's.
    std::vector<CellPoint> cells() const;
};

// Of a finished dataset.
LevelModel modelOf(const Hierarchy& hierarchy);
// From the octree with full resolution only, and what it has taken over from the old one.
LevelModel startModel(const Lattice& lattice, Tree::Records tree, const OldTree& old);
// Makes a node's box contain `box`, too.
void extendBox(std::int64_t (&low)[3], std::int64_t (&high)[3], const LatticeBox& box);
// Puts entries in order and completes the boxes of nodes; `pages`: those of all entries.
Hierarchy finishModel(LevelModel model, std::vector<PageRecord> pages);

}  // namespace iwalk
