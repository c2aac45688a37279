#include "preprocess/build/tree.hpp"

#include <algorithm>
#include <numeric>

namespace iwalk {
namespace {

void setBox(NodeRecord& node, const LatticeBox& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        node.boxMin[axis] = box.min[axis];
        node.boxMax[axis] = box.max[axis];
    }
}

}  // namespace

void setOwnBox(NodeRecord& node, const LatticeBox& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        node.ownMin[axis] = box.min[axis];
        node.ownMax[axis] = box.max[axis];
    }
}

std::uint32_t Tree::add(std::uint32_t parent, std::uint8_t octant, unsigned depth, std::uint32_t origin) {
    NodeRecord record{};
    record.depth = static_cast<std::uint8_t>(depth);
    setOwnBox(record, LatticeBox{});
    LevelRecord full{};
    full.level = kFullLevel;
    if (parent != kNone) setInterior(parent);
    nodes_.push_back({record, parent, origin, octant, full, static_cast<int>(depth) - 1, false});
    return static_cast<std::uint32_t>(nodes_.size() - 1);
}

LevelRecord& Tree::fullEntry(std::uint32_t node) {
    nodes_[node].record.entryCount = 1;
    return nodes_[node].full;
}

// Depth by depth; within one by the parents' places, then by octant: that is a row of children for each
// parent.
std::vector<std::uint32_t> Tree::breadthFirst() const {
    std::vector<std::uint32_t> order(nodes_.size()), place(nodes_.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto depthOf = [&](std::uint32_t node) { return nodes_[node].record.depth; };
    std::ranges::stable_sort(order, {}, depthOf);
    for (auto begin = order.begin(); begin != order.end();) {
        const auto end =
            std::find_if(begin, order.end(), [&](std::uint32_t n) { return depthOf(n) != depthOf(*begin); });
        std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
            const std::uint32_t parentA = nodes_[a].parent, parentB = nodes_[b].parent;
            if (parentA != parentB) return place[parentA] < place[parentB];
            return nodes_[a].octant < nodes_[b].octant;
        });
        for (auto i = begin; i != end; ++i) place[*i] = static_cast<std::uint32_t>(i - order.begin());
        begin = end;
    }
    return order;
}

Tree::Records Tree::finish() {
    const std::vector<std::uint32_t> order = breadthFirst();
    std::vector<std::uint32_t> place(order.size());
    Records records;
    records.nodes.reserve(order.size());
    for (const std::uint32_t number : order) {
        place[number] = static_cast<std::uint32_t>(records.nodes.size());
        NodeRecord& node = records.nodes.emplace_back(nodes_[number].record);
        node.firstEntry = static_cast<std::uint32_t>(records.entries.size());
        if (node.entryCount > 0) records.entries.push_back(nodes_[number].full);
        records.finest.push_back(nodes_[number].finest);
        records.origin.push_back(nodes_[number].origin);
        setBox(node, Hierarchy::ownBox(node));
    }
    // Children come later than their parents, so backwards every box is complete before it is passed on.
    for (std::size_t i = order.size(); i-- > 1;) {
        const Growing& node = nodes_[order[i]];
        NodeRecord& parent = records.nodes[place[node.parent]];
        LatticeBox box = Hierarchy::box(parent);
        box.add(Hierarchy::box(records.nodes[i]));
        setBox(parent, box);
        parent.childMask = static_cast<std::uint8_t>(parent.childMask | 1u << node.octant);
        parent.firstChild = static_cast<std::uint32_t>(i);
    }
    nodes_.clear();
    return records;
}

}  // namespace iwalk
