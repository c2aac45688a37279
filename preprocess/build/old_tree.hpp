#pragma once

#include <cstdint>
#include <vector>

#include "preprocess/levels/model.hpp"

namespace iwalk {

// The octree of the dataset that models are inserted into, in the root's cell as it is to be, and what of it
// new triangles touch. Nodes are known by their numbers in the dataset; above its root there may be new ones,
// with numbers behind those. Without a dataset there are none.
class OldTree {
  public:
    static constexpr std::uint32_t kNone = 0xffffffff;

    OldTree() = default;
    // `old` is kept by reference. `lattice`: with the new root's cell, which grownRoot() gave.
    OldTree(const LevelModel& old, const Lattice& lattice);

    bool exists() const { return old_ != nullptr; }
    // None where the new root has nothing to take over from it: when the old one is a leaf, all is touched.
    std::uint32_t root() const { return root_; }
    std::uint32_t child(std::uint32_t node, unsigned octant) const;
    bool isInterior(std::uint32_t node) const {
        return node != kNone && (isNew(node) || !old_->isLeaf(node));
    }
    bool isNew(std::uint32_t node) const { return node >= old_->nodes.size(); }
    // How many depths a node of the dataset lies deeper below the new root than below its own.
    unsigned grownBy() const { return grownBy_; }
    const LevelModel& model() const { return *old_; }

    // A new triangle, and its box.
    void touch(const TrianglePlace& place, const LatticeBox& box);
    // All new triangles are there. What shares a page with nodes whose triangles are touched is touched, too.
    void touchSharers();
    // Whether the node's own triangles go into new pages.
    bool isTouched(std::uint32_t node) const { return touched_[node]; }
    // Whether there are new ones among the node's own.
    bool hasGrown(std::uint32_t node) const { return grown_[node]; }
    // Contain all new triangles.
    const std::vector<LatticeBox>& changes() const { return changes_; }

  private:
    const LevelModel* old_ = nullptr;
    unsigned rootLog2_ = 0, grownBy_ = 0;
    std::uint32_t root_ = kNone;
    std::vector<std::uint8_t> ways_;     // of the nodes above the old root: the octant that it is in
    std::vector<bool> touched_, grown_;  // by node of the dataset
    std::vector<LatticeBox> changes_;    // by node, where the ways of new triangles end
};

// The old root's cell, doubled until it holds `bounds` (lattice). The log2 of its edge may be more than a
// hierarchy can have.
Lattice grownRoot(const Lattice& old, const LatticeBox& bounds);

}  // namespace iwalk
