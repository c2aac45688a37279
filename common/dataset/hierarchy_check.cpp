#include "common/dataset/hierarchy_check.hpp"

#include <algorithm>

#include "common/dataset/page.hpp"

namespace iwalk {
namespace {

bool isInLattice(const LatticeBox& box) {
    const LatticeBox all{LatticePoint(-kLatticeLimit), LatticePoint(kLatticeLimit)};
    return !box.empty() && all.contains(box);
}

// What a node owns of one page.
struct Claim {
    std::uint32_t page, firstRange, rangeCount;
    std::uint64_t triangles;
};

// Checks a hierarchy against itself and its manifest. The parts run in order: later ones rely on earlier
// ones.
class Checker {
  public:
    Checker(std::string path, const Hierarchy& hierarchy, const Manifest& manifest)
        : path_(std::move(path)), hierarchy_(hierarchy), manifest_(manifest) {}

    Result<void> run() {
        RETURN_IF_ERROR(checkRoot());
        RETURN_IF_ERROR(checkPages());
        RETURN_IF_ERROR(checkNodes());
        RETURN_IF_ERROR(checkTree());
        RETURN_IF_ERROR(checkClaims());
        return checkTotals();
    }

  private:
    template <class... Args>
    Error nodeError(std::size_t node, fmt::format_string<Args...> format, Args&&... args) const {
        const std::size_t place = kHierarchyHeaderBytes + node * sizeof(NodeRecord);
        return fail("{}: node {} at byte {}: {}; {}", path_, node, place,
                    fmt::format(format, std::forward<Args>(args)...), kHierarchyDamaged);
    }
    Error pageError(std::size_t page, const std::string& what) const {
        const std::size_t place =
            kHierarchyHeaderBytes + hierarchy_.nodes.size() * sizeof(NodeRecord) + page * sizeof(PageRecord);
        return fail("{}: page record {} at byte {}: {}; {}", path_, page, place, what, kHierarchyDamaged);
    }

    Result<void> checkRoot() const {
        if (hierarchy_.nodes.empty()) return fail("{}: no nodes; {}", path_, kHierarchyDamaged);
        const bool sane = hierarchy_.rootCellLog2 <= 61;
        LatticeBox cell{hierarchy_.rootCell, hierarchy_.rootCell};
        if (!sane || !isInLattice(cell))
            return fail("{}: root cell out of bounds; {}", path_, kHierarchyDamaged);
        return {};
    }

    Result<void> checkPages() const {
        for (std::size_t i = 0; i < hierarchy_.pages.size(); ++i) {
            const PageRecord& page = hierarchy_.pages[i];
            if (const auto good = checkPageRecord(page); !good) return pageError(i, good.error().message);
            if (page.file >= manifest_.pageFiles.size())
                return pageError(i, "names a file that is not there");
            const std::uint64_t fileBytes = manifest_.pageFiles[page.file].bytes;
            if (page.bytes > fileBytes || page.offset > fileBytes - page.bytes) {
                return pageError(i, "reaches beyond the end of its file");
            }
            const std::uint32_t attributes =
                (manifest_.colors ? kPageColors : 0u) | (manifest_.normals ? kPageNormals : 0u);
            if ((page.flags & ~kPageWide) != attributes)
                return pageError(i, "attributes are not the manifest's");
        }
        return {};
    }

    // Each node by itself.
    Result<void> checkNodes() const {
        for (std::size_t i = 0; i < hierarchy_.nodes.size(); ++i) {
            const NodeRecord& node = hierarchy_.nodes[i];
            if (node.depth > hierarchy_.rootCellLog2)
                return nodeError(i, "depth {} is too large", node.depth);
            if (std::ranges::any_of(node.reserved, [](std::uint8_t byte) { return byte != 0; })) {
                return nodeError(i, "reserved bytes are not 0");
            }
            if (!isInLattice(Hierarchy::box(node))) return nodeError(i, "box out of bounds");
            RETURN_IF_ERROR(checkOwn(i, node));
        }
        return {};
    }

    Result<void> checkOwn(std::size_t i, const NodeRecord& node) const {
        if ((node.triangles == 0) != (node.pageCount == 0))
            return nodeError(i, "triangles without pages, or pages without");
        if (node.pageCount == 0) {
            const bool blank = Hierarchy::ownBox(node) == LatticeBox{} && node.firstPage == 0 &&
                               node.firstRange == 0 && node.rangeCount == 0;
            return blank ? Result<void>{} : nodeError(i, "owns nothing, yet is not blank");
        }
        if (!isInLattice(Hierarchy::ownBox(node))) return nodeError(i, "own box out of bounds");
        const std::size_t pages = hierarchy_.pages.size();
        if (node.firstPage >= pages || node.pageCount > pages - node.firstPage) {
            return nodeError(i, "pages from {} on, {} of them, where there are {}", node.firstPage,
                             node.pageCount, pages);
        }
        if (node.pageCount > 1 && (node.firstRange != 0 || node.rangeCount != 0)) {
            return nodeError(i, "several pages and yet ranges");
        }
        if (node.pageCount == 1) {
            const std::uint32_t ranges = hierarchy_.pages[node.firstPage].rangeCount;
            if (node.rangeCount == 0 || std::uint32_t{node.firstRange} + node.rangeCount > ranges) {
                return nodeError(i, "ranges from {} on, {} of them, where page {} has {}", node.firstRange,
                                 node.rangeCount, node.firstPage, ranges);
            }
        }
        return {};
    }

    // Parents before children, every node reached once, depths and boxes as parents say.
    Result<void> checkTree() const {
        const std::vector<NodeRecord>& nodes = hierarchy_.nodes;
        if (nodes[0].depth != 0) return nodeError(0, "the root's depth is {}", nodes[0].depth);
        std::vector<bool> reached(nodes.size(), false);
        reached[0] = true;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            LatticeBox content = Hierarchy::ownBox(nodes[i]);
            const std::size_t count = static_cast<std::size_t>(Hierarchy::childCount(nodes[i]));
            if (count == 0 && nodes[i].firstChild != 0) return nodeError(i, "a leaf with children");
            if (count == 0 && nodes[i].triangles == 0) return nodeError(i, "an empty leaf");
            if (count > 0 && (nodes[i].firstChild <= i || nodes[i].firstChild > nodes.size() - count)) {
                return nodeError(i, "children from {} on, {} of them, of {}", nodes[i].firstChild, count,
                                 nodes.size());
            }
            for (std::size_t c = nodes[i].firstChild; c < nodes[i].firstChild + count; ++c) {
                if (reached[c]) return nodeError(c, "has two parents");
                reached[c] = true;
                if (nodes[c].depth != nodes[i].depth + 1)
                    return nodeError(c, "depth is not its parent's plus one");
                content.add(Hierarchy::box(nodes[c]));
            }
            if (content != Hierarchy::box(nodes[i])) return nodeError(i, "box is not that of its content");
        }
        const auto lost = std::ranges::find(reached, false);
        if (lost != reached.end())
            return nodeError(static_cast<std::size_t>(lost - reached.begin()), "has no parent");
        return {};
    }

    std::vector<Claim> claims() const {
        std::vector<Claim> all;
        for (const NodeRecord& node : hierarchy_.nodes) {
            if (node.pageCount == 1)
                all.push_back({node.firstPage, node.firstRange, node.rangeCount, node.triangles});
            for (std::uint32_t p = 0; node.pageCount > 1 && p < node.pageCount; ++p) {
                const PageRecord& page = hierarchy_.pages[node.firstPage + p];
                all.push_back({node.firstPage + p, 0, page.rangeCount, page.indexCount / 3});
                // A hostile file could make us collect claims without end; more than one a range is wrong
                // anyway.
                if (all.size() > hierarchy_.nodes.size() + hierarchy_.pages.size()) return all;
            }
        }
        std::ranges::sort(all, {}, [](const Claim& c) { return std::pair(c.page, c.firstRange); });
        return all;
    }

    // Every range of every page belongs to exactly one node, and the triangles add up.
    Result<void> checkClaims() const {
        const std::vector<Claim> all = claims();
        std::size_t next = 0;
        for (std::size_t p = 0; p < hierarchy_.pages.size(); ++p) {
            std::uint64_t ranges = 0, triangles = 0;
            for (; next < all.size() && all[next].page == p; ++next) {
                if (all[next].firstRange != ranges)
                    return pageError(p, "a range belongs to two nodes or none");
                ranges += all[next].rangeCount;
                if (all[next].triangles > kMaxPageIndices / 3)
                    return pageError(p, "a node has too many triangles");
                triangles += all[next].triangles;
            }
            if (ranges != hierarchy_.pages[p].rangeCount) return pageError(p, "a range belongs to no node");
            if (triangles != hierarchy_.pages[p].indexCount / 3)
                return pageError(p, "its nodes' triangles do not add up");
        }
        if (next != all.size())
            return fail("{}: pages belong to several nodes; {}", path_, kHierarchyDamaged);
        return checkLargeNodes();
    }

    // Of nodes with several pages the claims above only said what the pages hold.
    Result<void> checkLargeNodes() const {
        for (std::size_t i = 0; i < hierarchy_.nodes.size(); ++i) {
            const NodeRecord& node = hierarchy_.nodes[i];
            if (node.pageCount <= 1) continue;
            std::uint64_t triangles = 0;
            for (std::uint32_t p = 0; p < node.pageCount; ++p) {
                triangles += hierarchy_.pages[node.firstPage + p].indexCount / 3;
            }
            if (triangles != node.triangles)
                return nodeError(i, "has {} triangles, its pages {}", node.triangles, triangles);
        }
        return {};
    }

    Result<void> checkTotals() const {
        std::uint64_t triangles = 0, vertices = 0, leaves = 0;
        for (const NodeRecord& node : hierarchy_.nodes) {
            triangles += node.triangles;
            leaves += node.childMask == 0 ? 1 : 0;
        }
        for (const PageRecord& page : hierarchy_.pages) vertices += page.vertexCount;
        const bool same = triangles == manifest_.triangles && vertices == manifest_.vertices &&
                          hierarchy_.nodes.size() == manifest_.nodes && leaves == manifest_.leaves &&
                          hierarchy_.pages.size() == manifest_.pages;
        if (same) return {};
        return fail("{}: counts are not those of {}; {}", path_, kManifestName, kHierarchyDamaged);
    }

    std::string path_;
    const Hierarchy& hierarchy_;
    const Manifest& manifest_;
};

}  // namespace

Result<void> checkHierarchy(const std::string& path, const Hierarchy& hierarchy, const Manifest& manifest) {
    return Checker(path, hierarchy, manifest).run();
}

}  // namespace iwalk
