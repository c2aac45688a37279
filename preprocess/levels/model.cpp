#include "preprocess/levels/model.hpp"

#include <algorithm>

#include "common/check.hpp"
#include "preprocess/build/old_tree.hpp"

namespace iwalk {
namespace {

// Calls visit(child, octant) for each.
template <class Visit>
void forChildren(const NodeRecord& node, Visit visit) {
    std::uint32_t child = node.firstChild;
    for (unsigned octant = 0; octant < 8; ++octant) {
        if ((node.childMask >> octant & 1) != 0) visit(child++, octant);
    }
}

// The finest level of a node's own triangles.
int finestOf(const Hierarchy& hierarchy, const NodeRecord& node) {
    const std::span<const LevelRecord> entries = hierarchy.entriesOf(node);
    const LevelRecord* const full = hierarchy.fullEntryOf(node);
    if (full == nullptr || entries.size() == 1) return node.depth - 1;
    const LevelRecord& next = entries[entries.size() - 2];
    // An interior node's own triangles may be at full resolution in its whole entry: then they do not move.
    const bool moves = !Hierarchy::isWhole(node, next) || hierarchy.pages[full->firstPage].morphBytes > 0;
    return moves ? next.level : node.depth - 1;
}

}  // namespace

const LevelRecord& LevelModel::entryAt(std::uint32_t node, unsigned level) const {
    const auto found =
        std::ranges::find(entries[node], static_cast<std::uint8_t>(level), &LevelRecord::level);
    CHECK(found != entries[node].end());
    return *found;
}

std::vector<EntrySource> LevelModel::sourcesOf(std::uint32_t node, unsigned level) const {
    std::vector<EntrySource> sources;
    const auto addOwn = [&](std::uint32_t from, std::uint64_t way, unsigned wayLevels) {
        const bool full = finest[from] <= static_cast<int>(level);
        sources.push_back({entryAt(from, full ? kFullLevel : level + 1), way, wayLevels,
                           finest[from] < static_cast<int>(level)});
    };
    if (owns(node)) addOwn(node, 0, 0);
    if (!hasWhole(node, level)) return sources;
    forChildren(nodes[node], [&](std::uint32_t child, unsigned octant) {
        if (isLeaf(child)) {
            addOwn(child, octant, 1);
        } else {
            sources.push_back({entryAt(child, level + 1), octant, 1, false});
        }
    });
    return sources;
}

std::vector<std::uint32_t> LevelModel::depthFirst() const {
    std::vector<std::uint32_t> order, open{0};
    while (!open.empty()) {
        const std::uint32_t node = open.back();
        open.pop_back();
        order.push_back(node);
        const std::size_t first = open.size();
        forChildren(nodes[node], [&](std::uint32_t child, unsigned) { open.push_back(child); });
        std::reverse(open.begin() + static_cast<std::ptrdiff_t>(first), open.end());
    }
    return order;
}

std::vector<CellPoint> LevelModel::cells() const {
    std::vector<CellPoint> corners(nodes.size(), CellPoint(0));
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        forChildren(nodes[n], [&](std::uint32_t child, unsigned octant) {
            const std::uint64_t half = std::uint64_t{1} << (lattice.rootCellLog2 - nodes[n].depth - 1);
            corners[child] =
                corners[n] + CellPoint(octant & 1 ? half : 0, octant & 2 ? half : 0, octant & 4 ? half : 0);
        });
    }
    return corners;
}

int LevelModel::finestLevel() const {
    int level = -1;
    for (std::uint32_t node = 0; node < nodes.size(); ++node) {
        const int own = owns(node) ? finest[node] : -1;
        level = std::max({level, own, isLeaf(node) ? -1 : static_cast<int>(depth(node))});
    }
    return level;
}

LevelModel modelOf(const Hierarchy& hierarchy) {
    LevelModel model{{0, hierarchy.rootCell, hierarchy.rootCellLog2}, hierarchy.nodes, {}, {}, {}};
    for (const NodeRecord& node : hierarchy.nodes) {
        const std::span<const LevelRecord> entries = hierarchy.entriesOf(node);
        model.entries.emplace_back(entries.rbegin(), entries.rend());
        model.finest.push_back(finestOf(hierarchy, node));
    }
    return model;
}

LevelModel startModel(const Lattice& lattice, Tree::Records tree, const OldTree& old) {
    LevelModel model{lattice, std::move(tree.nodes), std::move(tree.finest), {}, std::move(tree.origin)};
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
        NodeRecord& node = model.nodes[n];
        const auto first = tree.entries.begin() + node.firstEntry;
        model.entries.emplace_back(first, first + node.entryCount);
        if (model.origin[n] == Tree::kNone) continue;
        const NodeRecord& origin = old.model().nodes[model.origin[n]];
        std::ranges::copy(origin.opacity, node.opacity);
        // Of what it keeps at coarser levels.
        if (node.childMask != 0) extendBox(node.boxMin, node.boxMax, Hierarchy::box(origin));
    }
    return model;
}

void extendBox(std::int64_t (&low)[3], std::int64_t (&high)[3], const LatticeBox& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], box.min[axis]);
        high[axis] = std::max(high[axis], box.max[axis]);
    }
}

Hierarchy finishModel(LevelModel model, std::vector<PageRecord> pages) {
    Hierarchy hierarchy;
    hierarchy.rootCell = model.lattice.rootCell;
    hierarchy.rootCellLog2 = model.lattice.rootCellLog2;
    hierarchy.nodes = std::move(model.nodes);
    hierarchy.pages = std::move(pages);
    for (std::size_t n = 0; n < hierarchy.nodes.size(); ++n) {
        NodeRecord& node = hierarchy.nodes[n];
        node.firstEntry = static_cast<std::uint32_t>(hierarchy.entries.size());
        node.entryCount = static_cast<std::uint8_t>(model.entries[n].size());
        hierarchy.entries.insert(hierarchy.entries.end(), model.entries[n].rbegin(), model.entries[n].rend());
    }
    for (std::size_t n = hierarchy.nodes.size(); n-- > 0;) {
        NodeRecord& node = hierarchy.nodes[n];
        LatticeBox box = Hierarchy::box(node);
        box.add(Hierarchy::ownBox(node));
        forChildren(node,
                    [&](std::uint32_t child, unsigned) { box.add(Hierarchy::box(hierarchy.nodes[child])); });
        extendBox(node.boxMin, node.boxMax, box);
    }
    return hierarchy;
}

}  // namespace iwalk
