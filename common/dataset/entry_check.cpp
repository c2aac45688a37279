#include <algorithm>
#include <tuple>

#include "common/dataset/hierarchy_check.hpp"
#include "common/dataset/page.hpp"

namespace iwalk {
namespace {

constexpr int kNoLevel = -1;  // nothing is coarser

// What an entry has of one page.
struct Claim {
    std::uint32_t page, firstRange, rangeCount;
    std::uint64_t triangles, vertices;
    std::uint8_t level;
    int coarser;  // the level that its morph targets are of, or kNoLevel
};

class EntryChecker {
  public:
    EntryChecker(const RecordErrors& errors, const Hierarchy& hierarchy)
        : errors_(errors), hierarchy_(hierarchy), coarsest_(coarsestLevel(hierarchy.rootCellLog2)) {}

    Result<void> run() {
        for (std::size_t i = 0; i < hierarchy_.nodes.size(); ++i) {
            RETURN_IF_ERROR(checkLevels(i, hierarchy_.nodes[i]));
            const std::size_t first = hierarchy_.nodes[i].firstEntry;
            for (std::size_t e = 0; e < hierarchy_.nodes[i].entryCount; ++e) {
                RETURN_IF_ERROR(checkEntry(first + e, hierarchy_.entries[first + e]));
            }
        }
        return checkClaims();
    }

  private:
    // Builders without levels make trees of full entries alone. Here, and nowhere else, it is decided that
    // interior nodes may be without their own level then.
    bool mayLackLevels() const { return !hierarchy_.hasLevels(); }

    // The levels of a node: which, that none is left out, and that errors fall.
    Result<void> checkLevels(std::size_t i, const NodeRecord& node) const {
        const std::span<const LevelRecord> entries = hierarchy_.entriesOf(node);
        const bool leaf = Hierarchy::isLeaf(node);
        if (leaf && entries.empty()) return errors_.node(i, "an empty leaf");
        const bool above = !mayLackLevels() && node.depth < coarsest_;
        if (above && (leaf || !entries.empty())) {
            return errors_.node(i, "has entries of its own, where levels begin at {}", coarsest_);
        }
        if (!leaf && !above && !mayLackLevels() && (entries.empty() || entries[0].level != node.depth)) {
            return errors_.node(i, "not a leaf, yet does not have level {} first", node.depth);
        }
        for (std::size_t e = 0; e < entries.size(); ++e) {
            const unsigned next = e == 0 ? node.depth : entries[e - 1].level + 1u;
            const bool last = e + 1 == entries.size();
            const bool inOrder = entries[e].level == kFullLevel ? last : entries[e].level == next;
            if (!inOrder)
                return errors_.node(i, "has level {} where {} or full comes next", entries[e].level, next);
            if (e > 0 && entries[e].error > entries[e - 1].error) {
                return errors_.node(i, "the error grows from its entry {} to the next, which is finer",
                                    e - 1);
            }
        }
        const bool whole = !entries.empty() && Hierarchy::isWhole(node, entries[0]);
        const bool owns = entries.size() > (whole ? 1u : 0u);
        if (owns && entries.back().level != kFullLevel) return errors_.node(i, "is never at full resolution");
        if (owns == (Hierarchy::ownBox(node) == LatticeBox{})) {
            return errors_.node(i, "own triangles without a box, or a box without");
        }
        return {};
    }

    // Each entry by itself.
    Result<void> checkEntry(std::size_t e, const LevelRecord& entry) const {
        const bool full = entry.level == kFullLevel;
        if (!full && mayLackLevels()) return errors_.entry(e, "a level, where the first entry is full");
        if (!full && entry.level > hierarchy_.rootCellLog2) {
            return errors_.entry(e, "level {} is too large", entry.level);
        }
        if (std::ranges::any_of(entry.reserved, [](std::uint8_t byte) { return byte != 0; })) {
            return errors_.entry(e, "reserved bytes are not 0");
        }
        const double bound = full ? 0 : levelErrorSteps(hierarchy_.rootCellLog2, entry.level);
        if (!(entry.error >= 0 && entry.error <= bound)) {
            return errors_.entry(e, "error {} is not from 0 to {}", entry.error, bound);
        }
        // At a coarse level everything may have become points, which are not stored.
        if (entry.triangles == 0 && !full) {
            const bool blank = entry.vertices == 0 && entry.pageCount == 0 && entry.firstPage == 0 &&
                               entry.firstRange == 0 && entry.rangeCount == 0;
            return blank ? Result<void>() : errors_.entry(e, "has no triangles, yet is not blank");
        }
        if (entry.triangles == 0 || entry.pageCount == 0)
            return errors_.entry(e, "triangles or pages are missing");
        if (entry.vertices == 0 || entry.vertices > std::uint64_t{3} * entry.triangles) {
            return errors_.entry(e, "{} triangles with {} vertices", entry.triangles, entry.vertices);
        }
        return checkPlace(e, entry);
    }

    Result<void> checkPlace(std::size_t e, const LevelRecord& entry) const {
        const std::size_t pages = hierarchy_.pages.size();
        if (entry.firstPage >= pages || entry.pageCount > pages - entry.firstPage) {
            return errors_.entry(e, "pages from {} on, {} of them, where there are {}", entry.firstPage,
                                 entry.pageCount, pages);
        }
        if (entry.pageCount > 1) {
            if (entry.firstRange == 0 && entry.rangeCount == 0) return {};
            return errors_.entry(e, "several pages and yet ranges");
        }
        const std::uint32_t ranges = hierarchy_.pages[entry.firstPage].rangeCount;
        if (entry.rangeCount > 0 && std::uint32_t{entry.firstRange} + entry.rangeCount <= ranges) return {};
        return errors_.entry(e, "ranges from {} on, {} of them, where page {} has {}", entry.firstRange,
                             entry.rangeCount, entry.firstPage, ranges);
    }

    // The level that entry `e` of the node turns into.
    int coarserLevel(const NodeRecord& node, std::size_t e) const {
        if (!hierarchy_.hasLevels()) return kNoLevel;
        if (e > 0) return int{hierarchy_.entriesOf(node)[e - 1].level};
        return node.depth == coarsest_ ? kNoLevel : int{node.depth} - 1;
    }

    std::vector<Claim> claims() const {
        std::vector<Claim> all;
        for (const NodeRecord& node : hierarchy_.nodes) {
            const std::span<const LevelRecord> entries = hierarchy_.entriesOf(node);
            for (std::size_t e = 0; e < entries.size(); ++e) {
                addClaims(entries[e], coarserLevel(node, e), all);
                // A hostile file could make us collect claims without end; with more than one a range it is
                // wrong anyway.
                if (all.size() > hierarchy_.entries.size() + hierarchy_.pages.size()) return all;
            }
        }
        return all;
    }

    void addClaims(const LevelRecord& entry, int coarser, std::vector<Claim>& all) const {
        if (entry.pageCount == 1) {
            all.push_back({entry.firstPage, entry.firstRange, entry.rangeCount, entry.triangles,
                           entry.vertices, entry.level, coarser});
            return;
        }
        const std::size_t most = hierarchy_.entries.size() + hierarchy_.pages.size();
        for (std::uint32_t p = entry.firstPage; p < entry.firstPage + entry.pageCount; ++p) {
            const PageRecord& page = hierarchy_.pages[p];
            all.push_back(
                {p, 0, page.rangeCount, page.indexCount / 3, page.vertexCount, entry.level, coarser});
            if (all.size() > most) return;
        }
    }

    // Every range of every page belongs to exactly one entry.
    Result<void> checkClaims() const {
        std::vector<Claim> all = claims();
        std::ranges::sort(all, {}, [](const Claim& c) { return std::pair(c.page, c.firstRange); });
        std::size_t next = 0;
        for (std::uint32_t p = 0; p < hierarchy_.pages.size(); ++p) {
            const std::size_t first = next;
            while (next < all.size() && all[next].page == p) ++next;
            RETURN_IF_ERROR(checkPage(p, std::span(all).subspan(first, next - first)));
        }
        return checkLargeEntries();
    }

    Result<void> checkPage(std::uint32_t p, std::span<const Claim> claims) const {
        const PageRecord& page = hierarchy_.pages[p];
        std::uint64_t ranges = 0, triangles = 0, vertices = 0;
        for (const Claim& claim : claims) {
            if (claim.firstRange != ranges) return errors_.page(p, "a range belongs to two entries or none");
            ranges += claim.rangeCount;
            triangles += claim.triangles;
            vertices += claim.vertices;
            if (claim.vertices > page.vertexCount)
                return errors_.page(p, "an entry uses more vertices than there are");
            if (claim.level != claims[0].level) return errors_.page(p, "is of two levels");
            if (page.morphBytes != 0 && (claim.coarser != claims[0].coarser || claim.coarser == kNoLevel)) {
                return errors_.page(p, "its morph block is of two levels, or of none");
            }
        }
        if (ranges != page.rangeCount) return errors_.page(p, "a range belongs to no entry");
        if (triangles != page.indexCount / 3) return errors_.page(p, "its entries' triangles do not add up");
        if (vertices < page.vertexCount) return errors_.page(p, "its entries' vertices do not add up");
        return {};
    }

    // Of entries with several pages the claims above only said what the pages hold.
    Result<void> checkLargeEntries() const {
        for (std::size_t e = 0; e < hierarchy_.entries.size(); ++e) {
            const LevelRecord& entry = hierarchy_.entries[e];
            if (entry.pageCount <= 1) continue;
            std::uint64_t triangles = 0, vertices = 0;
            for (std::uint32_t p = entry.firstPage; p < entry.firstPage + entry.pageCount; ++p) {
                triangles += hierarchy_.pages[p].indexCount / 3;
                vertices += hierarchy_.pages[p].vertexCount;
            }
            if (triangles != entry.triangles || vertices != entry.vertices) {
                return errors_.entry(e, "has {} triangles and {} vertices, its pages {} and {}",
                                     entry.triangles, entry.vertices, triangles, vertices);
            }
        }
        return {};
    }

    const RecordErrors& errors_;
    const Hierarchy& hierarchy_;
    const unsigned coarsest_;
};

}  // namespace

Result<void> checkEntries(const RecordErrors& errors, const Hierarchy& hierarchy) {
    return EntryChecker(errors, hierarchy).run();
}

}  // namespace iwalk
