#include "common/dataset/hierarchy_check.hpp"

#include <algorithm>

#include "common/dataset/level_summary.hpp"
#include "common/dataset/page.hpp"

namespace iwalk {
namespace {

bool isInLattice(const LatticeBox& box) {
    const LatticeBox all{LatticePoint(-kLatticeLimit), LatticePoint(kLatticeLimit)};
    return !box.empty() && all.contains(box);
}

// Checks a hierarchy against itself and its manifest. The parts run in order: later ones rely on earlier
// ones.
class Checker {
  public:
    Checker(const std::string& path, const Hierarchy& hierarchy, const Manifest& manifest)
        : errors_(path, hierarchy), hierarchy_(hierarchy), manifest_(manifest) {}

    Result<void> run() {
        RETURN_IF_ERROR(checkRoot());
        RETURN_IF_ERROR(checkPages());
        RETURN_IF_ERROR(checkNodes());
        RETURN_IF_ERROR(checkTree());
        RETURN_IF_ERROR(checkEntries(errors_, hierarchy_));
        return checkTotals();
    }

  private:
    Result<void> checkRoot() const {
        if (hierarchy_.nodes.empty()) return errors_.file("no nodes");
        const LatticeBox corner{hierarchy_.rootCell, hierarchy_.rootCell};
        if (hierarchy_.rootCellLog2 > 61 || !isInLattice(corner)) {
            return errors_.file("root cell out of bounds");
        }
        return {};
    }

    Result<void> checkPages() const {
        const std::uint32_t attributes =
            (manifest_.colors ? kPageColors : 0u) | (manifest_.normals ? kPageNormals : 0u);
        for (std::size_t i = 0; i < hierarchy_.pages.size(); ++i) {
            const PageRecord& page = hierarchy_.pages[i];
            if (const auto good = checkPageRecord(page); !good)
                return errors_.page(i, "{}", good.error().message);
            RETURN_IF_ERROR(checkPlace(i, page.file, page.offset, page.bytes));
            RETURN_IF_ERROR(checkPlace(i, page.morphFile, page.morphOffset, page.morphBytes));
            if ((page.flags & (kPageColors | kPageNormals)) != attributes) {
                return errors_.page(i, "attributes are not the manifest's");
            }
        }
        return {};
    }

    Result<void> checkPlace(std::size_t page, std::size_t file, std::uint64_t offset,
                            std::uint64_t bytes) const {
        if (file >= manifest_.pageFiles.size()) return errors_.page(page, "names a file that is not there");
        const std::uint64_t fileBytes = manifest_.pageFiles[file].bytes;
        if (bytes <= fileBytes && offset <= fileBytes - bytes) return {};
        return errors_.page(page, "reaches beyond the end of its file");
    }

    // Each node by itself, and that their entries follow one another.
    Result<void> checkNodes() const {
        std::size_t entries = 0;
        for (std::size_t i = 0; i < hierarchy_.nodes.size(); ++i) {
            const NodeRecord& node = hierarchy_.nodes[i];
            if (node.depth > hierarchy_.rootCellLog2)
                return errors_.node(i, "depth {} is too large", node.depth);
            if (node.reserved != 0) return errors_.node(i, "reserved byte is not 0");
            const bool opacity = std::ranges::any_of(node.opacity, [](std::uint8_t o) { return o != 0; });
            if (opacity && !Hierarchy::isLeaf(node)) return errors_.node(i, "not a leaf, yet has opacities");
            if (!isInLattice(Hierarchy::box(node))) return errors_.node(i, "box out of bounds");
            const LatticeBox own = Hierarchy::ownBox(node);
            if (own != LatticeBox{} && !isInLattice(own)) return errors_.node(i, "own box out of bounds");
            if (node.firstEntry != entries || node.entryCount > hierarchy_.entries.size() - entries) {
                return errors_.node(i, "entries from {} on, {} of them, where {} of {} come next",
                                    node.firstEntry, node.entryCount, entries, hierarchy_.entries.size());
            }
            entries += node.entryCount;
        }
        if (entries == hierarchy_.entries.size()) return {};
        return errors_.file("{} level records, of which nodes have {}", hierarchy_.entries.size(), entries);
    }

    // Parents before children, every node reached once, depths and boxes as parents say.
    Result<void> checkTree() const {
        const std::vector<NodeRecord>& nodes = hierarchy_.nodes;
        if (nodes[0].depth != 0) return errors_.node(0, "the root's depth is {}", nodes[0].depth);
        std::vector<bool> reached(nodes.size(), false);
        reached[0] = true;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const LatticeBox box = Hierarchy::box(nodes[i]);
            if (!box.contains(Hierarchy::ownBox(nodes[i])))
                return errors_.node(i, "own box reaches out of its box");
            const std::size_t count = static_cast<std::size_t>(Hierarchy::childCount(nodes[i]));
            if (count == 0 && nodes[i].firstChild != 0) return errors_.node(i, "a leaf with children");
            const std::size_t first = nodes[i].firstChild;
            if (count > 0 && (first <= i || first > nodes.size() || count > nodes.size() - first)) {
                return errors_.node(i, "children from {} on, {} of them, of {}", first, count, nodes.size());
            }
            for (std::size_t c = first; c < first + count; ++c) {
                if (reached[c]) return errors_.node(c, "has two parents");
                reached[c] = true;
                if (nodes[c].depth != nodes[i].depth + 1) {
                    return errors_.node(c, "depth is not its parent's plus one");
                }
                if (!box.contains(Hierarchy::box(nodes[c]))) {
                    return errors_.node(c, "box reaches out of its parent's");
                }
            }
        }
        const auto lost = std::ranges::find(reached, false);
        if (lost == reached.end()) return {};
        return errors_.node(static_cast<std::size_t>(lost - reached.begin()), "has no parent");
    }

    Result<void> checkTotals() const {
        std::uint64_t vertices = 0, leaves = 0;
        for (const NodeRecord& node : hierarchy_.nodes) leaves += Hierarchy::isLeaf(node) ? 1 : 0;
        for (const PageRecord& page : hierarchy_.pages) vertices += page.vertexCount;
        const LevelSummaries levels = summariseLevels(hierarchy_, manifest_.stepExponent);
        const bool same = levels.full.triangles == manifest_.triangles && vertices == manifest_.vertices &&
                          hierarchy_.nodes.size() == manifest_.nodes && leaves == manifest_.leaves &&
                          hierarchy_.pages.size() == manifest_.pages;
        if (!same) return errors_.file("counts are not those of {}", kManifestName);
        if (levels == LevelSummaries{manifest_.levels, manifest_.full}) return {};
        return errors_.file("levels are not those of {}", kManifestName);
    }

    const RecordErrors errors_;
    const Hierarchy& hierarchy_;
    const Manifest& manifest_;
};

}  // namespace

Result<void> checkHierarchy(const std::string& path, const Hierarchy& hierarchy, const Manifest& manifest) {
    return Checker(path, hierarchy, manifest).run();
}

}  // namespace iwalk
