#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/build/old_tree.hpp"
#include "preprocess/build/record.hpp"

namespace iwalk {

// Nodes and their triangles, found in memory. Numbers are local until the nodes enter the Tree.
struct Subtree {
    struct Node {
        std::uint32_t parent;  // kNoParent: the node that the subtree hangs on
        std::uint8_t octant;
        std::uint8_t depth;
        std::uint32_t old;  // the node of the old tree that it is, or OldTree::kNone
        bool kept;          // with all that the old tree has below it
    };
    struct Own {
        std::uint32_t node;
        std::size_t first, count;  // in the order; in depth-first order of the nodes
    };
    std::vector<Node> nodes;
    std::vector<Own> owned;
};

// Splits the triangles `order` of `records`, which all belong into the cell of one node at `depth` and are
// more than a leaf may have or in a node of the old tree, `old`; reorders them so that each node's lie side
// by side, else in the order they had.
Subtree growSubtree(const RecordFormat& format, const std::uint32_t* records, std::span<std::uint32_t> order,
                    unsigned depth, std::uint8_t octant, std::uint64_t leafTriangles, const OldTree& tree,
                    std::uint32_t old);

}  // namespace iwalk
