#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/hierarchy.hpp"

namespace iwalk {

// The octree as it grows, in any order; nodes are known by number. The root is added first, with no parent.
class Tree {
  public:
    static constexpr std::uint32_t kNone = 0xffffffff;

    std::uint32_t add(std::uint32_t parent, std::uint8_t octant, unsigned depth);
    // Own triangles, box and pages of a node; the rest is finish()'s.
    NodeRecord& operator[](std::uint32_t node) { return nodes_[node].record; }
    const NodeRecord& operator[](std::uint32_t node) const { return nodes_[node].record; }

    // Puts children in rows behind their parents and computes the boxes of the content. Leaves the tree
    // empty.
    std::vector<NodeRecord> finish();

  private:
    struct Growing {
        NodeRecord record;
        std::uint32_t parent;
        std::uint8_t octant;
    };
    std::vector<Growing> nodes_;
};

// Sets a node's own box.
void setOwnBox(NodeRecord& node, const LatticeBox& box);

}  // namespace iwalk
