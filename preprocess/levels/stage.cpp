#include "preprocess/levels/stage.hpp"

#include <algorithm>

#include "preprocess/levels/detail.hpp"

namespace iwalk {
namespace {

class Maker {
  public:
    Maker(const LevelModel& model, unsigned level, PageWriter& writer)
        : model_(model), level_(level), writer_(writer) {
        stage_.level = level;
        stage_.limits = limitsAt(model.lattice.rootCellLog2, level);
        stage_.errors = &writer.errors();
        stage_.errorUnit = limitsAt(model.lattice.rootCellLog2, level + 1).error;
    }

    Stage run() {
        const std::vector<std::uint32_t> order = model_.depthFirst();
        for (const std::uint32_t node : order) {
            const LevelRecord* const entry = changingEntry(model_, node, level_);
            if (entry != nullptr) add(node, *entry, false);
        }
        stage_.changing = stage_.pages.size();
        for (const std::uint32_t node : order) {
            if (isHeld(model_, node, level_)) add(node, model_.entryAt(node, kFullLevel), true);
        }
        return std::move(stage_);
    }

  private:
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
                                   shared ? entry.rangeCount : page.record.rangeCount, whole});
            page.error = std::max(page.error, entry.error);
            addBox(page, whole ? Hierarchy::box(model_.nodes[node]) : Hierarchy::ownBox(model_.nodes[node]));
        }
    }

    void addPage(std::uint32_t number, bool held) {
        StagePage page;
        page.number = number;
        page.record = writer_.records()[number];
        page.held = held;
        page.fresh = writer_.isNew(number);
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
    PageWriter& writer_;
    Stage stage_;
};

}  // namespace

Stage makeStage(const LevelModel& model, unsigned level, PageWriter& writer) {
    return Maker(model, level, writer).run();
}

const LevelRecord* changingEntry(const LevelModel& model, std::uint32_t node, unsigned level) {
    const unsigned finer = level + 1;
    if (model.hasWhole(node, finer) || model.hasOwn(node, finer)) return &model.entryAt(node, finer);
    const bool turns = model.fullAt(node, finer) && model.finest[node] == static_cast<int>(level);
    return turns ? &model.entryAt(node, kFullLevel) : nullptr;
}

bool isHeld(const LevelModel& model, std::uint32_t node, unsigned level) {
    return model.fullAt(node, level + 1) && model.finest[node] < static_cast<int>(level);
}

CollapseLimits limitsAt(unsigned rootCellLog2, unsigned level) {
    const float error = static_cast<float>(levelErrorSteps(rootCellLog2, level));
    return {error, kEdgesPerError * error};
}

}  // namespace iwalk
