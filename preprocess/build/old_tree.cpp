#include "preprocess/build/old_tree.hpp"

#include <algorithm>
#include <bit>

namespace iwalk {
namespace {

bool holds(const Lattice& lattice, const LatticeBox& bounds) {
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        const std::int64_t top = lattice.rootCell[axis] + (std::int64_t{1} << lattice.rootCellLog2);
        if (bounds.min[axis] < lattice.rootCell[axis] || bounds.max[axis] >= top) return false;
    }
    return true;
}

}  // namespace

Lattice grownRoot(const Lattice& old, const LatticeBox& bounds) {
    Lattice lattice = old;
    while (lattice.rootCellLog2 < 62 && !holds(lattice, bounds)) {
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            if (bounds.min[axis] >= lattice.rootCell[axis]) continue;
            lattice.rootCell[axis] -= std::int64_t{1} << lattice.rootCellLog2;
        }
        ++lattice.rootCellLog2;
    }
    return lattice;
}

OldTree::OldTree(const LevelModel& old, const Lattice& lattice)
    : old_(&old), rootLog2_(lattice.rootCellLog2), grownBy_(lattice.rootCellLog2 - old.lattice.rootCellLog2) {
    touched_.assign(old.nodes.size(), false);
    grown_.assign(old.nodes.size(), false);
    changes_.resize(old.nodes.size() + grownBy_);
    if (old.isLeaf(0)) {
        touched_[0] = true;
        changes_[0] = Hierarchy::box(old.nodes[0]);
        return;
    }
    // From the old root up.
    for (unsigned up = 0; up < grownBy_; ++up) {
        std::uint8_t octant = 0;
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            const std::int64_t cells =
                (old.lattice.rootCell[axis] - lattice.rootCell[axis]) >> old.lattice.rootCellLog2;
            octant = static_cast<std::uint8_t>(octant | (cells >> up & 1) << axis);
        }
        ways_.push_back(octant);
    }
    root_ = grownBy_ == 0 ? 0 : static_cast<std::uint32_t>(old.nodes.size()) + grownBy_ - 1;
}

std::uint32_t OldTree::child(std::uint32_t node, unsigned octant) const {
    if (node == kNone) return kNone;
    const auto olds = static_cast<std::uint32_t>(old_->nodes.size());
    if (node >= olds) {
        if (octant != ways_[node - olds]) return kNone;
        return node == olds ? 0 : node - 1;
    }
    const NodeRecord& record = old_->nodes[node];
    if ((record.childMask >> octant & 1) == 0) return kNone;
    return record.firstChild +
           static_cast<std::uint32_t>(std::popcount(record.childMask & ((1u << octant) - 1)));
}

void OldTree::touch(const TrianglePlace& place, const LatticeBox& box) {
    if (old_ == nullptr) return;
    if (root_ == kNone) return changes_[0].add(box);
    std::uint32_t node = root_;
    for (unsigned depth = 0;; ++depth) {
        const bool isOwn = depth == place.depth || !isInterior(node);
        const unsigned below = rootLog2_ - depth - 1;  // not used where it is own
        const auto bit = [&](int axis) { return static_cast<unsigned>(place.centroid[axis] >> below & 1); };
        const std::uint32_t next = isOwn ? kNone : child(node, bit(0) | bit(1) << 1 | bit(2) << 2);
        if (isOwn && !isNew(node)) touched_[node] = grown_[node] = true;
        if (next == kNone) return changes_[node].add(box);
        node = next;
    }
}

void OldTree::touchSharers() {
    if (old_ == nullptr) return;
    std::vector<std::uint32_t> pages;
    const auto visit = [&](auto what) {
        for (std::uint32_t node = 0; node < old_->nodes.size(); ++node) {
            if (old_->owns(node) && old_->entries[node].front().pageCount == 1) {
                what(node, old_->entries[node].front().firstPage);
            }
        }
    };
    visit([&](std::uint32_t node, std::uint32_t page) {
        if (touched_[node]) pages.push_back(page);
    });
    std::ranges::sort(pages);
    visit([&](std::uint32_t node, std::uint32_t page) {
        if (std::ranges::binary_search(pages, page)) touched_[node] = true;
    });
    std::erase_if(changes_, [](const LatticeBox& box) { return box.empty(); });
}

}  // namespace iwalk
