#include "preprocess/levels/choose_cells.hpp"

#include <algorithm>
#include <tuple>

#include "preprocess/levels/entry_triangles.hpp"
#include "preprocess/levels/old_targets.hpp"

namespace iwalk {
namespace {

// What one cell decides about at once: large enough that few vertices lie at borders.
constexpr std::uint64_t kCellTriangles = 65536;
// Cells are not smaller than this many times the level's error, since vertices near their borders stay.
constexpr float kLeastCell = 16;
// Nor larger than this many times, so that an insert does not decide again what is far away. Raised: fewer
// cells with less at their borders.
constexpr float kMostCell = 8192;

// Of the pass that made or makes the model's `level`.
std::vector<LatticeCell> cellsOf(const LevelModel& model, unsigned level) {
    const std::vector<CellPoint> corners = model.cells();
    std::vector<Weight> weights;
    for (std::uint32_t node = 0; node < model.nodes.size(); ++node) {
        const LevelRecord* const entry = changingEntry(model, node, level);
        if (entry == nullptr) continue;
        const std::uint64_t edge = std::uint64_t{1} << (model.lattice.rootCellLog2 - model.depth(node));
        weights.push_back({model.lattice.fromCell(corners[node]), edge, entry->triangles});
    }
    const int errorLog2 = static_cast<int>(model.lattice.rootCellLog2) - static_cast<int>(level);
    const float error = limitsAt(model.lattice.rootCellLog2, level).error;
    const CellSizes sizes{kCellTriangles, static_cast<std::uint64_t>(kLeastCell * error),
                          static_cast<std::uint64_t>(kMostCell * error)};
    return cutCells(weights, errorLog2, sizes);
}

bool comesBefore(const LatticeCell& a, const LatticeCell& b) {
    const auto key = [](const LatticeCell& c) {
        return std::tuple(c.low.x, c.low.y, c.low.z, c.high.x, c.high.y, c.high.z);
    };
    return key(a) < key(b);
}

// A cell, and whether it must be decided.
struct Choice {
    SpaceCell cell;
    bool chosen;
};

// The vertices of triangles that the owners of a new page did not have before.
Result<std::vector<bool>> changedVertices(const LevelModel& model, const Stage& stage, const StagePage& page,
                                          const SourcePage& source, const OldTree& old,
                                          const PageWriter& writer, PageStore& store) {
    std::vector<bool> changed(source.positions.size(), false);
    for (const PageOwner& owner : page.owners) {
        const LevelRecord* const entry = oldSource(old, model, stage, page, owner);
        EntryTriangles before;
        if (entry != nullptr) RETURN_IF_ERROR(before.read(*entry, writer.records(), store));
        forTriangles(source, owner.firstRange, owner.rangeCount, [&](std::uint32_t i) {
            if (before.has(source, i)) return;
            for (const std::uint16_t v : std::span(source.indices).subspan(i, 3)) changed[v] = true;
        });
    }
    return changed;
}

// Chooses the cells that these vertices of the page lie in.
void choose(const StagePage& page, const SourcePage& source, const std::vector<bool>& vertices,
            std::vector<Choice>& choices) {
    for (Choice& choice : choices) {
        if (choice.chosen || !choice.cell.meets(page.low, page.high)) continue;
        for (std::size_t v = 0; v < vertices.size() && !choice.chosen; ++v) {
            choice.chosen = vertices[v] && choice.cell.contains(source.positions[v]);
        }
    }
}

}  // namespace

Result<std::vector<SpaceCell>> chooseCells(const LevelModel& model, const Stage& stage, const OldTree& old,
                                           const PageWriter& writer, PageStore& store) {
    const std::optional<unsigned> before = oldLevel(old, stage.level);
    std::vector<LatticeCell> same;
    if (before) same = cellsOf(old.model(), *before);
    std::ranges::sort(same, comesBefore);
    std::vector<Choice> choices;
    for (const LatticeCell& cell : cellsOf(model, stage.level)) {
        const bool isNew = !std::ranges::binary_search(same, cell, comesBefore);
        if (const auto inside = inRoot(cell, model.lattice)) choices.push_back({*inside, isNew});
    }
    for (const StagePage& page : stage.pages) {
        if (!page.fresh || !before) continue;
        ASSIGN_OR_RETURN(const std::shared_ptr<const SourcePage> source, store.get(page.number, page.record));
        ASSIGN_OR_RETURN(const std::vector<bool> changed,
                         changedVertices(model, stage, page, *source, old, writer, store));
        choose(page, *source, changed, choices);
    }
    std::vector<SpaceCell> cells;
    for (const Choice& choice : choices) {
        if (choice.chosen) cells.push_back(choice.cell);
    }
    return cells;
}

}  // namespace iwalk
