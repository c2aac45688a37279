#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/hierarchy.hpp"

namespace iwalk {

// The octree as it grows, in any order; nodes are known by number. The root is added first, with no parent.
class Tree {
  public:
    static constexpr std::uint32_t kNone = 0xffffffff;

    // `origin`: the node of the dataset that is inserted into that it is, or kNone.
    std::uint32_t add(std::uint32_t parent, std::uint8_t octant, unsigned depth,
                      std::uint32_t origin = kNone);
    // Own box of a node; the rest is finish()'s.
    NodeRecord& operator[](std::uint32_t node) { return nodes_[node].record; }
    const NodeRecord& operator[](std::uint32_t node) const { return nodes_[node].record; }
    // Of the node's own triangles; blank when it is first asked for.
    LevelRecord& fullEntry(std::uint32_t node);
    // The finest level of the node's own triangles; depth - 1 when nobody says.
    int& finest(std::uint32_t node) { return nodes_[node].finest; }
    // It has children, or is to have some.
    void setInterior(std::uint32_t node) { nodes_[node].interior = true; }
    bool isInterior(std::uint32_t node) const { return nodes_[node].interior; }
    std::uint32_t origin(std::uint32_t node) const { return nodes_[node].origin; }

    struct Records {
        std::vector<NodeRecord> nodes;
        std::vector<LevelRecord> entries;   // full
        std::vector<int> finest;            // by node
        std::vector<std::uint32_t> origin;  // by node
    };
    // Puts children in rows behind their parents, entries in the order of their nodes, and computes the boxes
    // of the content. Leaves the tree empty.
    Records finish();

  private:
    struct Growing {
        NodeRecord record;
        std::uint32_t parent, origin;
        std::uint8_t octant;
        LevelRecord full;
        int finest;
        bool interior;
    };
    std::vector<std::uint32_t> breadthFirst() const;

    std::vector<Growing> nodes_;
};

// Sets a node's own box.
void setOwnBox(NodeRecord& node, const LatticeBox& box);

}  // namespace iwalk
