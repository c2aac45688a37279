#include <array>
#include <map>
#include <optional>
#include <utility>

#include "tests/tools/levels/range_model.hpp"

namespace iwalk::levels {
namespace {

// A cell of the octree by its lowest corner in cells of its own size from the root's, and its depth.
struct Cell {
    std::array<std::uint64_t, 3> corner{0, 0, 0};
    unsigned depth = 0;
    auto operator<=>(const Cell&) const = default;

    Cell child(unsigned octant) const {
        Cell result{{}, depth + 1};
        for (std::size_t axis = 0; axis < 3; ++axis)
            result.corner[axis] = 2 * corner[axis] + (octant >> axis & 1);
        return result;
    }
    Cell parent() const { return {{corner[0] / 2, corner[1] / 2, corner[2] / 2}, depth - 1}; }
};

std::vector<Cell> nodeCells(const Hierarchy& hierarchy) {
    std::vector<Cell> cells(hierarchy.nodes.size());
    for (std::size_t n = 0; n < hierarchy.nodes.size(); ++n) {
        std::uint32_t child = hierarchy.nodes[n].firstChild;
        for (unsigned octant = 0; octant < 8; ++octant) {
            if ((hierarchy.nodes[n].childMask >> octant & 1) != 0) cells[child++] = cells[n].child(octant);
        }
    }
    return cells;
}

std::vector<std::uint32_t> nodeParents(const Hierarchy& hierarchy) {
    std::vector<std::uint32_t> parents(hierarchy.nodes.size(), kNoRange);
    for (std::uint32_t n = 0; n < hierarchy.nodes.size(); ++n) {
        const NodeRecord& node = hierarchy.nodes[n];
        for (int c = 0; c < Hierarchy::childCount(node); ++c)
            parents[node.firstChild + static_cast<std::uint32_t>(c)] = n;
    }
    return parents;
}

Cell cellOf(Cell node, std::uint32_t path) {
    for (unsigned level = pathLevels(path); level-- > 0;) node = node.child(path >> 3 * level & 7);
    return node;
}

class Loader {
  public:
    explicit Loader(const DatasetPages& pages)
        : pages_(pages),
          cells_(nodeCells(pages.hierarchy())),
          parents_(nodeParents(pages.hierarchy())),
          model_(static_cast<int>(pages.manifest().levels.size())) {}

    Result<RangeModel> load() && {
        const auto add = [this](const EntryPlace& place, const DecodedPage& page, const Range& range) {
            addRange(place, page, range);
        };
        RETURN_IF_ERROR(pages_.visitRanges(pages_.allEntries(), true, add));
        connect();
        return std::move(model_);
    }

  private:
    using EntryKey = std::pair<std::uint32_t, std::uint32_t>;  // node, entry

    // Ranges of one entry that have one cell are one.
    void addRange(const EntryPlace& place, const DecodedPage& page, const Range& range) {
        const Cell cell = cellOf(cells_[place.node], range.path);
        const int level = pages_.entry(place).level;
        const int next = pages_.nextLevel(place);
        const auto [found, added] = byCell_[{place.node, place.entry}].try_emplace(cell, kNoRange);
        if (added) {
            found->second =
                model_.add({{}, level == kFullLevel ? model_.fullLevel() : level, next, kNoRange, {}});
        }
        CutRange& target = model_.ranges()[found->second];
        const LatticePoint& origin = pages_.hierarchy().rootCell;
        const LatticeBox box = page.box(range);
        target.box.add({box.min - origin, box.max - origin});
        for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; ++i) {
            const LatticePoint& p = page.positions[page.indices[i]];
            const LatticePoint& q = page.targets.empty() ? p : page.targets[page.indices[i]];
            target.corners.push_back(model_.vertex(p - origin, q - origin, next));
        }
    }

    // Of an entry the one that is drawn in its place where the model is coarser.
    std::optional<EntryKey> coarser(const EntryKey& entry) const {
        if (pages_.nextLevel({entry.first, entry.second}) < 0) return std::nullopt;
        if (entry.second > 0) return EntryKey{entry.first, entry.second - 1};
        return EntryKey{parents_[entry.first], 0};
    }

    void connect() {
        for (const auto& [entry, ranges] : byCell_) {
            for (const auto& [cell, range] : ranges) connectRange(entry, cell, range);
        }
    }

    // All triangles of a cell may be gone at the next coarser level: a range with none takes their place,
    // beyond the same distance as others, and so on from there.
    void connectRange(EntryKey entry, const Cell& cell, std::uint32_t range) {
        while (const auto up = coarser(entry)) {
            const std::uint32_t parent = rangeAround(*up, cell);
            if (parent != kNoRange) {
                model_.ranges()[range].parent = parent;
                return;
            }
            const CutRange& finer = model_.ranges()[range];
            const std::uint32_t none = model_.add({finer.box, finer.next, finer.next - 1, kNoRange, {}});
            model_.ranges()[range].parent = none;
            ++model_.vanished;
            entry = *up, range = none;
        }
    }

    std::uint32_t rangeAround(const EntryKey& entry, Cell cell) const {
        const auto ranges = byCell_.find(entry);
        if (ranges == byCell_.end()) return kNoRange;
        for (;; cell = cell.parent()) {
            const auto found = ranges->second.find(cell);
            if (found != ranges->second.end()) return found->second;
            if (cell.depth == 0) return kNoRange;
        }
    }

    const DatasetPages& pages_;
    std::vector<Cell> cells_;             // of nodes
    std::vector<std::uint32_t> parents_;  // of nodes
    std::map<EntryKey, std::map<Cell, std::uint32_t>> byCell_;
    RangeModel model_;
};

}  // namespace

Result<RangeModel> loadRangeModel(const DatasetPages& pages) {
    return Loader(pages).load();
}

}  // namespace iwalk::levels
