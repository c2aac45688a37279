#include "preprocess/levels/levels.hpp"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <mutex>

#include "preprocess/levels/apply.hpp"
#include "preprocess/levels/opacities.hpp"
#include "preprocess/levels/parallel.hpp"

namespace iwalk {
namespace {

constexpr unsigned kMostRootLog2 = 32;
// What one cell decides about at once: large enough that few vertices lie at borders.
constexpr std::uint64_t kCellTriangles = 65536;
// Cells are not smaller than this many times the level's error, since vertices near their borders stay.
constexpr float kLeastCell = 16;

class Pass {
  public:
    Pass(LevelTools& tools, Stage stage, ChunkFile& spill)
        : tools_(tools), stage_(std::move(stage)), targets_(spill, stage_) {}

    Result<void> run(Progress& progress) {
        progress.phase(fmt::format("making level {}", stage_.level));
        RETURN_IF_ERROR(decide([&](double part) { progress.done(0.7 * part); }));
        RETURN_IF_ERROR(targets_.finish());
        LevelApplier applier(tools_, stage_, targets_);
        return applier.run([&](double part) { progress.done(0.7 + 0.3 * part); });
    }

  private:
    Result<void> decide(const std::function<void(double)>& done) {
        const std::vector<SpaceCell> cells =
            cutCells(stage_.weights, tools_.model.lattice.rootCellLog2, stage_.level, kCellTriangles,
                     static_cast<std::uint64_t>(kLeastCell * stage_.limits.error));
        std::mutex mutex;
        std::size_t decided = 0;
        return parallelFor(tools_.arena, 0, cells.size(), [&](std::size_t i) -> Result<void> {
            std::vector<VertexTarget> targets;
            RETURN_IF_ERROR(decideCell(cells[i], stage_, touching(cells[i]), tools_.store, targets));
            const std::lock_guard lock(mutex);
            done(static_cast<double>(++decided) / static_cast<double>(cells.size()));
            return targets_.add(targets);
        });
    }

    // The stage's pages that reach into the cell.
    std::vector<std::uint32_t> touching(const SpaceCell& cell) const {
        std::vector<std::uint32_t> found;
        for (std::uint32_t i = 0; i < stage_.pages.size(); ++i) {
            const StagePage& page = stage_.pages[i];
            bool meets = true;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                meets = meets && page.low[axis] < cell.high[axis] && page.high[axis] >= cell.low[axis];
            }
            if (meets) found.push_back(i);
        }
        return found;
    }

    LevelTools& tools_;
    Stage stage_;
    TargetBins targets_;
};

}  // namespace

Result<void> makeLevels(LevelModel& model, const RecordFormat& format, const LevelOptions& options,
                        PageWriter& writer, ChunkFile& spill, Progress& progress) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, options.threads);
    tbb::task_arena arena(static_cast<int>(options.threads));
    writer.setFormat(format);
    ASSIGN_OR_RETURN(std::unique_ptr<RandomAccessFile> file, openForReading(options.pagesPath));
    PageStore store(std::move(file), model.lattice, options.storeBytes);
    RETURN_IF_ERROR(writer.flush());
    progress.phase("finding opacities");
    const auto done = [&](double part) { progress.done(part); };
    RETURN_IF_ERROR(findOpacities(model, writer.records(), store, arena, done));
    // Offsets in pages have 32 bits, and at coarse levels pages are as large as the root's cell. (A stray
    // vertex far out makes such a root; its dataset has full resolution only.)
    if (model.lattice.rootCellLog2 > kMostRootLog2) return {};
    LevelTools tools{model, format, options.leafTriangles, store, writer, arena};
    for (int level = model.finestLevel(); level >= 0; --level) {
        RETURN_IF_ERROR(writer.flush());
        Stage stage = makeStage(model, static_cast<unsigned>(level), writer.records());
        for (StagePage& page : stage.pages) page.errors = writer.takeErrors(page.number);
        RETURN_IF_ERROR(Pass(tools, std::move(stage), spill).run(progress));
    }
    return {};
}

}  // namespace iwalk
