#include "preprocess/levels/stage.hpp"

#include <algorithm>

#include "preprocess/levels/detail.hpp"

namespace iwalk {
namespace {

class Maker {
  public:
    Maker(const LevelModel& model, unsigned level, std::span<const PageRecord> records)
        : model_(model), level_(level), records_(records), cells_(model.cells()) {
        stage_.level = level;
        const auto limit = [&](unsigned l) {
            return static_cast<float>(levelErrorSteps(model.lattice.rootCellLog2, l));
        };
        stage_.errorUnit = limit(level + 1);
        stage_.limits.error = limit(level);
        stage_.limits.longestEdge = kEdgesPerError * limit(level);
    }

    Stage run() {
        const std::vector<std::uint32_t> order = model_.depthFirst();
        for (const std::uint32_t node : order) addChanging(node);
        stage_.changing = stage_.pages.size();
        for (const std::uint32_t node : order) {
            if (isHeld(node)) add(node, model_.entryAt(node, kFullLevel), true);
        }
        return std::move(stage_);
    }

  private:
    bool isHeld(std::uint32_t node) const {
        return model_.fullAt(node, level_ + 1) && model_.finest[node] < static_cast<int>(level_);
    }

    // What of the node is in the next finer level and is not held now.
    void addChanging(std::uint32_t node) {
        const unsigned finer = level_ + 1;
        if (model_.hasWhole(node, finer) || model_.hasOwn(node, finer)) {
            add(node, model_.entryAt(node, finer), false);
        } else if (model_.fullAt(node, finer) && model_.finest[node] == static_cast<int>(level_)) {
            add(node, model_.entryAt(node, kFullLevel), false);
        }
    }

    void add(std::uint32_t node, const LevelRecord& entry, bool held) {
        const bool whole = !model_.isLeaf(node) && entry.level == model_.depth(node);
        for (std::uint32_t number = entry.firstPage; number < entry.firstPage + entry.pageCount; ++number) {
            const auto [place, isNew] =
                stage_.places.emplace(number, static_cast<std::uint32_t>(stage_.pages.size()));
            if (isNew) addPage(number, held);
            StagePage& page = stage_.pages[place->second];
            CHECK(page.held == held);
            const bool shared = entry.pageCount == 1;
            page.owners.push_back({node, shared ? entry.firstRange : 0u,
                                   shared ? entry.rangeCount : records_[number].rangeCount, whole});
            addBox(page, whole ? Hierarchy::box(model_.nodes[node]) : Hierarchy::ownBox(model_.nodes[node]));
        }
        const std::uint64_t edge = std::uint64_t{1} << (model_.lattice.rootCellLog2 - model_.depth(node));
        if (!held) stage_.weights.push_back({cells_[node], edge, entry.triangles});
    }

    void addPage(std::uint32_t number, bool held) {
        StagePage page;
        page.number = number;
        page.record = records_[number];
        page.held = held;
        page.low = CellPoint(~std::uint64_t{0});
        stage_.pages.push_back(std::move(page));
    }

    void addBox(StagePage& page, const LatticeBox& box) const {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto steps = [&](std::int64_t value) {
                return static_cast<std::uint64_t>(value - model_.lattice.rootCell[axis]);
            };
            page.low[axis] = std::min(page.low[axis], steps(box.min[axis]));
            page.high[axis] = std::max(page.high[axis], steps(box.max[axis]));
        }
    }

    const LevelModel& model_;
    unsigned level_;
    std::span<const PageRecord> records_;
    std::vector<CellPoint> cells_;
    Stage stage_;
};

}  // namespace

Stage makeStage(const LevelModel& model, unsigned level, std::span<const PageRecord> records) {
    return Maker(model, level, records).run();
}

}  // namespace iwalk
