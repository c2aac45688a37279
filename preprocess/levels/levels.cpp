#include "preprocess/levels/levels.hpp"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <mutex>

#include "preprocess/build/parallel.hpp"
#include "preprocess/levels/apply.hpp"
#include "preprocess/levels/choose_cells.hpp"
#include "preprocess/levels/opacities.hpp"

namespace iwalk {
namespace {

class Pass {
  public:
    Pass(LevelTools& tools, Stage stage, ChunkFile& spill)
        : tools_(tools), stage_(std::move(stage)), targets_(spill, stage_) {}

    Result<void> run(Progress& progress) {
        progress.phase(fmt::format("making level {}", stage_.level));
        ASSIGN_OR_RETURN(stage_.cells,
                         chooseCells(tools_.model, stage_, tools_.old, tools_.writer, tools_.store));
        RETURN_IF_ERROR(decide([&](double part) { progress.done(0.7 * part); }));
        RETURN_IF_ERROR(targets_.finish());
        LevelApplier applier(tools_, stage_, targets_);
        return applier.run([&](double part) { progress.done(0.7 + 0.3 * part); });
    }

  private:
    Result<void> decide(const std::function<void(double)>& done) {
        const std::vector<SpaceCell>& cells = stage_.cells;
        std::mutex mutex;
        std::vector<bool> moved(stage_.pages.size(), false);
        std::size_t decided = 0;
        const auto work = [&](std::size_t i) -> Result<void> {
            ASSIGN_OR_RETURN(
                const CellDecision decision,
                decideCell(cells[i], stage_, touching(cells[i]), tools_.store, tools_.sizes.cellTriangles));
            const std::lock_guard lock(mutex);
            done(static_cast<double>(++decided) / static_cast<double>(cells.size()));
            for (const std::uint32_t page : decision.moved) moved[page] = true;
            return targets_.add(decision.targets);
        };
        RETURN_IF_ERROR(parallelFor(tools_.arena, 0, cells.size(), work));
        for (std::size_t page = 0; page < moved.size(); ++page) stage_.pages[page].moved = moved[page];
        return {};
    }

    // The stage's pages that reach into the cell.
    std::vector<std::uint32_t> touching(const SpaceCell& cell) const {
        std::vector<std::uint32_t> found;
        for (std::uint32_t i = 0; i < stage_.pages.size(); ++i) {
            if (cell.meets(stage_.pages[i].low, stage_.pages[i].high)) found.push_back(i);
        }
        return found;
    }

    LevelTools& tools_;
    Stage stage_;
    TargetBins targets_;
};

}  // namespace

Result<void> makeLevels(LevelModel& model, const RecordFormat& format, const LevelOptions& options,
                        const OldTree& old, PageStore& store, PageWriter& writer, ChunkFile& spill,
                        Progress& progress) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, options.threads);
    tbb::task_arena arena(static_cast<int>(options.threads));
    writer.setFormat(format);
    RETURN_IF_ERROR(writer.flush());
    progress.phase("finding opacities");
    const auto done = [&](double part) { progress.done(part); };
    RETURN_IF_ERROR(findOpacities(model, writer.records(), old, store, arena, done));
    LevelTools tools{model, format, options.leafTriangles, options.sizes, old, store, writer, spill, arena};
    const int coarsest = static_cast<int>(coarsestLevel(model.lattice.rootCellLog2));
    for (int level = model.finestLevel(); level >= coarsest; --level) {
        RETURN_IF_ERROR(writer.flush());
        Stage stage = makeStage(model, static_cast<unsigned>(level), writer);
        RETURN_IF_ERROR(Pass(tools, std::move(stage), spill).run(progress));
    }
    return {};
}

}  // namespace iwalk
