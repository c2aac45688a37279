#include "preprocess/command/summary.hpp"

#include <algorithm>

namespace iwalk {
namespace {

void addNode(const Hierarchy& hierarchy, const NodeRecord& node, Summary& summary) {
    if (node.depth >= summary.depths.size()) summary.depths.resize(std::size_t{node.depth} + 1);
    DepthSummary& depth = summary.depths[node.depth];
    ++depth.nodes;
    depth.triangles += hierarchy.ownTriangles(node);
    if (!Hierarchy::isLeaf(node)) return;
    ++depth.leaves;
    for (const std::uint8_t opacity : node.opacity) {
        ++summary.opacities[std::min(kOpacityBins - 1, kOpacityBins * opacity / 255)];
        summary.hasOpacity = summary.hasOpacity || opacity > 0;
    }
}

// Pages that entries share count once.
void addLevels(const Hierarchy& hierarchy, Summary& summary) {
    std::vector<std::uint8_t> levels(hierarchy.pages.size(), kFullLevel);
    const auto storedAt = [&](std::uint8_t level) -> StoredLevel& {
        if (level == kFullLevel) return summary.full;
        if (level >= summary.levels.size()) summary.levels.resize(std::size_t{level} + 1);
        return summary.levels[level];
    };
    for (const LevelRecord& entry : hierarchy.entries) {
        StoredLevel& stored = storedAt(entry.level);
        ++stored.entries;
        stored.triangles += entry.triangles;
        std::fill_n(levels.begin() + entry.firstPage, entry.pageCount, entry.level);
    }
    for (const std::uint8_t level : levels) ++storedAt(level).pages;
}

}  // namespace

Summary summarise(const Hierarchy& hierarchy) {
    Summary summary;
    for (const NodeRecord& node : hierarchy.nodes) addNode(hierarchy, node, summary);
    addLevels(hierarchy, summary);
    for (const PageRecord& page : hierarchy.pages) {
        summary.ranges += page.rangeCount;
        summary.triangles += page.indexCount / 3;
        summary.pageBytes += page.bytes;
        summary.morphBytes += page.morphBytes;
        summary.widePages += (page.flags & kPageWide) != 0 ? 1 : 0;
    }
    return summary;
}

}  // namespace iwalk
