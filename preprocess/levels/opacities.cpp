#include "preprocess/levels/opacities.hpp"

#include <algorithm>
#include <mutex>

#include "preprocess/build/parallel.hpp"
#include "preprocess/opacity/cell_opacity.hpp"

namespace iwalk {
namespace {

// Both with inclusive ends; steps from the root cell's corner.
struct StepBox {
    CellPoint low{0}, high{0};

    bool meets(const CellPoint& otherLow, const CellPoint& otherHigh) const {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (otherLow[axis] > high[axis] || otherHigh[axis] < low[axis]) return false;
        }
        return true;
    }
};

class LeafJob {
  public:
    LeafJob(const LevelModel& model, std::span<const PageRecord> records, PageStore& store,
            const StepBox& cell)
        : model_(model), records_(records), store_(store), cell_(cell) {}

    Result<std::array<std::uint8_t, kOpacityDirections>> run() {
        std::vector<std::uint32_t> open{0};
        while (!open.empty()) {
            const std::uint32_t node = open.back();
            open.pop_back();
            if (!meets(Hierarchy::box(model_.nodes[node]))) continue;
            if (model_.owns(node) && meets(Hierarchy::ownBox(model_.nodes[node]))) {
                RETURN_IF_ERROR(addEntry(model_.entryAt(node, kFullLevel)));
            }
            for (int c = 0; c < Hierarchy::childCount(model_.nodes[node]); ++c) {
                open.push_back(model_.nodes[node].firstChild + static_cast<std::uint32_t>(c));
            }
        }
        return opacity_.coefficients();
    }

  private:
    bool meets(const LatticeBox& box) const {
        const LatticePoint low = model_.lattice.fromCell(cell_.low),
                           high = model_.lattice.fromCell(cell_.high);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (box.min[axis] > high[axis] || box.max[axis] < low[axis]) return false;
        }
        return true;
    }

    Result<void> addEntry(const LevelRecord& entry) {
        for (std::uint32_t number = entry.firstPage; number < entry.firstPage + entry.pageCount; ++number) {
            ASSIGN_OR_RETURN(const std::shared_ptr<const SourcePage> page,
                             store_.get(number, records_[number]));
            const bool shared = entry.pageCount == 1;
            const auto ranges = shared ? std::span(page->ranges).subspan(entry.firstRange, entry.rangeCount)
                                       : std::span(page->ranges);
            for (const Range& range : ranges) addRange(*page, range);
        }
        return {};
    }

    void addRange(const SourcePage& page, const Range& range) {
        const CellPoint low = page.origin + CellPoint(range.boxMin[0], range.boxMin[1], range.boxMin[2]);
        const CellPoint high = page.origin + CellPoint(range.boxMax[0], range.boxMax[1], range.boxMax[2]);
        if (!cell_.meets(low, high)) return;
        corners_.clear();
        for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; ++i) {
            corners_.push_back(inCell(page.positions[page.indices[i]]));
        }
        opacity_.add(corners_);
    }

    glm::vec3 inCell(const CellPoint& p) const {
        const float edge = static_cast<float>(cell_.high.x - cell_.low.x);
        const auto part = [&](std::size_t axis) {
            return static_cast<float>(static_cast<std::int64_t>(p[axis] - cell_.low[axis])) / edge;
        };
        return {part(0), part(1), part(2)};
    }

    const LevelModel& model_;
    std::span<const PageRecord> records_;
    PageStore& store_;
    const StepBox& cell_;
    CellOpacity opacity_;
    std::vector<glm::vec3> corners_;
};

}  // namespace

Result<void> findOpacities(LevelModel& model, std::span<const PageRecord> records, const OldTree& old,
                           PageStore& store, tbb::task_arena& arena,
                           const std::function<void(double)>& done) {
    const std::vector<CellPoint> cells = model.cells();
    const auto cellOf = [&](std::uint32_t leaf) {
        const std::uint64_t edge = std::uint64_t{1} << (model.lattice.rootCellLog2 - model.depth(leaf));
        return StepBox{cells[leaf], cells[leaf] + edge};
    };
    const auto isKnown = [&](std::uint32_t leaf) {
        if (model.origin[leaf] == Tree::kNone) return false;
        const StepBox cell = cellOf(leaf);
        return std::ranges::none_of(old.changes(), [&](const LatticeBox& change) {
            return cell.meets(CellPoint(change.min - model.lattice.rootCell),
                              CellPoint(change.max - model.lattice.rootCell));
        });
    };
    std::vector<std::uint32_t> leaves = model.depthFirst();
    std::erase_if(leaves, [&](std::uint32_t node) { return !model.isLeaf(node) || isKnown(node); });
    std::mutex mutex;
    std::size_t finished = 0;
    return parallelFor(arena, 0, leaves.size(), [&](std::size_t i) -> Result<void> {
        const std::uint32_t leaf = leaves[i];
        const StepBox cell = cellOf(leaf);
        ASSIGN_OR_RETURN(const auto coefficients, LeafJob(model, records, store, cell).run());
        std::ranges::copy(coefficients, model.nodes[leaf].opacity);
        const std::lock_guard lock(mutex);
        done(static_cast<double>(++finished) / static_cast<double>(leaves.size()));
        return {};
    });
}

}  // namespace iwalk
