#include "preprocess/build/verify_places.hpp"

#include <algorithm>
#include <utility>

namespace iwalk {
namespace {

std::uint32_t pathTo(const LatticePoint& inNode, unsigned cellLog2, unsigned levels) {
    std::uint32_t path = kRootPath;
    for (unsigned level = 1; level <= levels; ++level) {
        const auto bit = [&](std::size_t axis) {
            return static_cast<std::uint32_t>(inNode[axis] >> (cellLog2 - level) & 1);
        };
        path = path << 3 | bit(2) << 2 | bit(1) << 1 | bit(0);
    }
    return path;
}

// Places of a cell's begin and end in the Morton order of the deepest cells.
std::pair<std::uint64_t, std::uint64_t> extentOf(std::uint32_t path) {
    const unsigned left = 3 * (kMaxPathLevels - pathLevels(path));
    const std::uint64_t begin = (std::uint64_t{path} << left) - (std::uint64_t{1} << 3 * kMaxPathLevels);
    return {begin, begin + (std::uint64_t{1} << left)};
}

}  // namespace

std::vector<Share> sharesOf(const Hierarchy& hierarchy) {
    std::vector<Share> shares;
    for (std::uint32_t n = 0; n < hierarchy.nodes.size(); ++n) {
        const NodeRecord& node = hierarchy.nodes[n];
        for (std::uint32_t e = node.firstEntry; e < node.firstEntry + node.entryCount; ++e) {
            const LevelRecord& entry = hierarchy.entries[e];
            for (std::uint32_t p = entry.firstPage; p < entry.firstPage + entry.pageCount; ++p) {
                const bool shared = entry.pageCount == 1;
                shares.push_back({p, shared ? entry.firstRange : 0u,
                                  shared ? entry.rangeCount : hierarchy.pages[p].rangeCount, n, e});
            }
        }
    }
    std::ranges::sort(shares, {}, [](const Share& share) { return std::pair(share.page, share.firstRange); });
    return shares;
}

PlaceChecker::PlaceChecker(const Hierarchy& hierarchy)
    : hierarchy_(hierarchy), cells_(cellsOfNodes(hierarchy)), lastPaths_(hierarchy.entries.size(), 0) {}

std::optional<std::string> PlaceChecker::check(const PlainPage& page, std::span<const Share> shares) {
    LatticePoint lowest = LatticeBox{}.min;
    for (const Share& share : shares) {
        for (std::uint32_t r = share.firstRange; r < share.firstRange + share.rangeCount; ++r) {
            const Range& range = page.ranges[r];
            std::optional<std::string> problem = checkRange(page, range, share);
            if (!problem && page.morph) problem = checkMorph(page, r, share);
            if (problem) return fmt::format("range {}: {}", r, *problem);
            for (glm::length_t axis = 0; axis < 3; ++axis) {
                lowest[axis] = std::min(lowest[axis], std::int64_t{range.boxMin[axis]});
            }
        }
    }
    if (lowest == LatticePoint(0)) return std::nullopt;
    return "origin is not the lowest corner of its ranges' boxes";
}

std::optional<std::string> PlaceChecker::checkRange(const PlainPage& page, const Range& range,
                                                    const Share& share) {
    const LatticeBox box = page.box(range);
    const LevelRecord& entry = hierarchy_.entries[share.entry];
    if (!Hierarchy::entryBox(hierarchy_.nodes[share.node], entry).contains(box)) {
        return fmt::format("box reaches out of that of node {}", share.node);
    }
    const std::span<const std::uint16_t> indices = page.indicesOf(range);
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        LatticeBox triangle;
        LatticePoint sum(0);
        for (std::size_t c = 0; c < 3; ++c) {
            const LatticePoint& p = page.positions[indices[i + c]];
            triangle.add(p);
            sum += p - hierarchy_.rootCell;
        }
        if (!box.contains(triangle)) return "box does not contain its triangles";
        // Images of triangles may lie outside of the cell that the triangles belong to.
        if (entry.level != kFullLevel) continue;
        if (!belongs(share.node, range.path, triangle.edge(), sum / std::int64_t{3})) {
            return fmt::format("triangle {} does not belong into node {}", i / 3, share.node);
        }
        ++fullTriangles_;
    }
    return checkPath(share, range.path);
}

// Cells follow one another in Morton order and do not overlap, unless paths end. An entry of everything below
// a node may have a cell before parts of it: what is too large for the node's children comes from less deep
// cells.
std::optional<std::string> PlaceChecker::checkPath(const Share& share, std::uint32_t path) {
    const std::uint32_t last = std::exchange(lastPaths_[share.entry], path);
    const unsigned levels = pathLevels(path);
    const unsigned most = std::min(kMaxPathLevels, cellLog2(share.node));
    if (levels > most) return fmt::format("path {:#x} is deeper than the lattice", path);
    if (last == 0 || (last == path && levels == most)) return std::nullopt;
    const auto [begin, end] = extentOf(path);
    const auto [lastBegin, lastEnd] = extentOf(last);
    const bool whole = Hierarchy::isWhole(hierarchy_.nodes[share.node], hierarchy_.entries[share.entry]);
    const bool follows =
        whole ? std::pair(begin, levels) >= std::pair(lastBegin, pathLevels(last)) : begin >= lastEnd;
    if (follows) return std::nullopt;
    return fmt::format("path {:#x} does not follow {:#x}", path, last);
}

std::optional<std::string> PlaceChecker::checkMorph(const PlainPage& page, std::size_t range,
                                                    const Share& share) const {
    const LatticeBox box = page.morphBox(range);
    for (const std::uint16_t index : page.indicesOf(page.ranges[range])) {
        const LatticePoint& target = page.targets[index];
        if (!box.contains(LatticeBox{target, target})) return "morph box does not contain its targets";
    }
    if (Hierarchy::box(hierarchy_.nodes[share.node]).contains(box)) return std::nullopt;
    return fmt::format("morph box reaches out of that of node {}", share.node);
}

unsigned PlaceChecker::cellLog2(std::uint32_t node) const {
    return hierarchy_.rootCellLog2 - hierarchy_.nodes[node].depth;
}

// Whether a triangle is one of the cell's.
bool PlaceChecker::belongs(std::uint32_t n, std::uint32_t path, std::int64_t longest,
                           const LatticePoint& centroid) const {
    const std::int64_t edge = std::int64_t{1} << cellLog2(n);
    const LatticePoint inNode = centroid + hierarchy_.rootCell - cells_[n];
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        if (inNode[axis] < 0 || inNode[axis] >= edge) return false;
    }
    // In an interior node only what is too large for its children.
    const bool isSmall = !Hierarchy::isLeaf(hierarchy_.nodes[n]) && 2 * longest <= edge;
    return longest <= edge && !isSmall && pathContains(path, pathTo(inNode, cellLog2(n), pathLevels(path)));
}

}  // namespace iwalk
