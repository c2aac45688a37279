#include "preprocess/levels/apply.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "common/dataset/morph.hpp"
#include "preprocess/build/parallel.hpp"
#include "preprocess/levels/remake.hpp"

namespace iwalk {
namespace {

// Source triangles at once in memory, with what becomes of them; more only when a single node has more.
constexpr std::uint64_t kChunkTriangles = 200'000;

void addBox(NodeRecord& node, bool whole, const LatticeBox& box) {
    if (whole) return extendBox(node.boxMin, node.boxMax, box);
    extendBox(node.ownMin, node.ownMax, box);
}

// Whether the page gets a morph block.
bool isMorphNew(const StagePage& page) {
    return page.fresh || page.moved;
}

}  // namespace

LevelApplier::LevelApplier(LevelTools& tools, Stage& stage, TargetBins& targets)
    : tools_(tools), stage_(stage), targets_(targets), packer_(tools.format, tools.leafTriangles) {
    if (const std::optional<unsigned> before = oldLevel(tools.old, stage.level)) {
        oldTargets_.emplace(tools.old, tools.model, tools.writer, tools.store, *before);
    }
}

Result<void> LevelApplier::run(const std::function<void(double)>& done) {
    const std::vector<Job> jobs = planJobs();
    // The first page that jobs from here on need.
    std::vector<std::uint32_t> needed(jobs.size() + 1, static_cast<std::uint32_t>(stage_.changing));
    for (std::size_t i = jobs.size(); i-- > 0;) needed[i] = std::min(needed[i + 1], jobs[i].firstPage);
    for (std::size_t begin = 0, end = 0; begin < jobs.size(); begin = end) {
        std::uint64_t triangles = 0;
        std::uint32_t lastPage = 0;
        for (; end < jobs.size() && (end == begin || triangles + jobs[end].triangles <= kChunkTriangles);
             ++end) {
            triangles += jobs[end].triangles;
            lastPage = std::max(lastPage, jobs[end].lastPage);
        }
        RETURN_IF_ERROR(loadUpTo(lastPage + 1));
        RETURN_IF_ERROR(makeEntries(std::span(jobs).subspan(begin, end - begin)));
        RETURN_IF_ERROR(writePages());
        release(needed[end]);
        done(static_cast<double>(end) / static_cast<double>(jobs.size()));
    }
    RETURN_IF_ERROR(loadUpTo(static_cast<std::uint32_t>(stage_.changing)));
    packer_.finish();
    return writePages();
}

std::vector<LevelApplier::Job> LevelApplier::planJobs() {
    const LevelModel& model = tools_.model;
    const std::vector<bool> make = keepEntries(tools_.model, stage_, tools_.old);
    std::vector<Job> jobs;
    for (const std::uint32_t node : model.depthFirst()) {
        if (!make[node]) continue;
        Job job{node, model.sourcesOf(node, stage_.level), std::numeric_limits<std::uint32_t>::max(), 0, 0};
        for (const EntrySource& source : job.sources) {
            job.triangles += source.entry.triangles;
            if (source.held) continue;
            const std::uint32_t first = source.entry.firstPage, last = first + source.entry.pageCount - 1;
            job.firstPage = std::min(job.firstPage, stage_.places.at(first));
            job.lastPage = std::max(job.lastPage, stage_.places.at(last));
            for (std::uint32_t page = first; page <= last; ++page)
                stage_.pages[stage_.places.at(page)].needed = true;
        }
        jobs.push_back(std::move(job));
    }
    return jobs;
}

// The stage's pages before `end`, and their morph blocks to disk.
Result<void> LevelApplier::loadUpTo(std::uint32_t end) {
    const std::uint32_t step = 16 * static_cast<std::uint32_t>(tools_.arena.max_concurrency());
    for (;;) {
        const std::uint32_t begin = firstLoaded_ + static_cast<std::uint32_t>(loaded_.size());
        if (begin >= end) return {};
        RETURN_IF_ERROR(load(begin, std::min(end, begin + step)));
    }
}

Result<void> LevelApplier::load(std::uint32_t begin, std::uint32_t end) {
    loaded_.resize(end - firstLoaded_);
    const auto at = [&](std::size_t index) -> Loaded& { return loaded_[index - firstLoaded_]; };
    const auto read = [&](std::size_t i) -> Result<void> {
        const StagePage& page = stage_.pages[i];
        if (!isMorphNew(page) && !page.needed) return {};
        ASSIGN_OR_RETURN(at(i).page, tools_.store.get(page.number, page.record));
        return findTargets(static_cast<std::uint32_t>(i));
    };
    const auto take = [&](std::size_t i) -> Result<void> {
        return at(i).page ? targets_.take(static_cast<std::uint32_t>(i), at(i).targets) : Result<void>();
    };
    RETURN_IF_ERROR(orderedFor(tools_.arena, begin, end, read, take));
    const auto encode = [&](std::size_t i) -> Result<void> {
        if (isMorphNew(stage_.pages[i])) encodeMorph(static_cast<std::uint32_t>(i));
        return {};
    };
    const auto write = [&](std::size_t i) -> Result<void> {
        return isMorphNew(stage_.pages[i]) ? writeMorph(static_cast<std::uint32_t>(i)) : Result<void>();
    };
    return orderedFor(tools_.arena, begin, end, encode, write);
}

// Where the page's vertices go as far as decisions do not say: they stay in cells that were decided, and go
// where they went before in others.
Result<void> LevelApplier::findTargets(std::uint32_t index) {
    const StagePage& stagePage = stage_.pages[index];
    Loaded& loaded = loaded_[index - firstLoaded_];
    const SourcePage& page = *loaded.page;
    ASSIGN_OR_RETURN(loaded.targets, stayingTargets(stage_, stagePage, page));
    if (!oldTargets_) return {};  // all cells were decided
    std::vector<const SpaceCell*> cells;
    for (const SpaceCell& cell : stage_.cells) {
        if (cell.meets(stagePage.low, stagePage.high)) cells.push_back(&cell);
    }
    std::vector<bool> decided;
    for (const CellPoint& p : page.positions) {
        decided.push_back(
            std::ranges::any_of(cells, [&](const SpaceCell* cell) { return cell->contains(p); }));
    }
    if (std::ranges::find(decided, false) == decided.end()) return {};
    return oldTargets_->set(stage_, stagePage, page, decided, loaded.targets);
}

// The morph block to the file, and its targets into the boxes of nodes.
Result<void> LevelApplier::writeMorph(std::uint32_t index) {
    Loaded& loaded = loaded_[index - firstLoaded_];
    const StagePage& page = stage_.pages[index];
    RETURN_IF_ERROR(tools_.writer.appendMorph(page.number, std::exchange(loaded.morph, {})));
    for (std::size_t i = 0; i < page.owners.size(); ++i) {
        const PageOwner& owner = page.owners[i];
        addBox(tools_.model.nodes[owner.node], owner.whole, loaded.reach[i]);
    }
    return {};
}

void LevelApplier::encodeMorph(std::uint32_t index) {
    Loaded& loaded = loaded_[index - firstLoaded_];
    const Lattice& lattice = tools_.model.lattice;
    const auto lattices = [&](const std::vector<CellPoint>& points) {
        std::vector<LatticePoint> result;
        result.reserve(points.size());
        for (const CellPoint& p : points) result.push_back(lattice.fromCell(p));
        return result;
    };
    const SourcePage& page = *loaded.page;
    const std::vector<LatticePoint> positions = lattices(page.positions);
    const std::vector<LatticePoint> targets = lattices(loaded.targets.positions);
    PageRecord& record = tools_.writer.record(stage_.pages[index].number);
    record.flags &= ~std::uint32_t{kMorphWide};  // of the one it may have had
    const MorphSource source{lattice.fromCell(page.origin), positions, targets, page.ranges, page.indices};
    loaded.morph = iwalk::encodeMorph(source, record);
    for (const PageOwner& owner : stage_.pages[index].owners) {
        LatticeBox& box = loaded.reach.emplace_back();
        for (const Range& range : std::span(page.ranges).subspan(owner.firstRange, owner.rangeCount)) {
            for (std::uint32_t k = range.firstIndex; k < range.firstIndex + range.indexCount; ++k)
                box.add(targets[page.indices[k]]);
        }
    }
}

Result<void> LevelApplier::makeEntries(std::span<const Job> jobs) {
    std::vector<Slice> slices(jobs.size());
    const auto make = [&](std::size_t i) -> Result<void> {
        ASSIGN_OR_RETURN(slices[i], makeSlice(jobs[i]));
        return {};
    };
    const auto add = [&](std::size_t i) -> Result<void> {
        LevelRecord entry{};
        entry.level = static_cast<std::uint8_t>(stage_.level);
        // A bound for what has vanished, too.
        for (const EntrySource& source : jobs[i].sources)
            entry.error = std::max(entry.error, source.entry.error);
        tools_.model.entries[jobs[i].node].push_back(entry);
        packer_.add(std::move(slices[i]));
        return {};
    };
    return orderedFor(tools_.arena, 0, jobs.size(), make, add);
}

Result<Slice> LevelApplier::makeSlice(const Job& job) {
    std::vector<LevelSource> sources;
    std::vector<std::shared_ptr<const SourcePage>> held;
    for (const EntrySource& source : job.sources) {
        const LevelRecord& entry = source.entry;
        for (std::uint32_t number = entry.firstPage; number < entry.firstPage + entry.pageCount; ++number) {
            LevelSource part{nullptr, nullptr, 0, 0, source.way, source.wayLevels};
            if (source.held) {
                const PageRecord& record = stage_.pages[stage_.places.at(number)].record;
                ASSIGN_OR_RETURN(std::shared_ptr<const SourcePage> page, tools_.store.get(number, record));
                part.page = held.emplace_back(std::move(page)).get();
            } else {
                const Loaded& loaded = loaded_[stage_.places.at(number) - firstLoaded_];
                part.page = loaded.page.get();
                part.targets = &loaded.targets;
            }
            part.firstRange = entry.pageCount == 1 ? entry.firstRange : 0u;
            part.rangeCount = entry.pageCount == 1 ? entry.rangeCount
                                                   : static_cast<std::uint32_t>(part.page->ranges.size());
            sources.push_back(part);
        }
    }
    const LevelModel& model = tools_.model;
    const unsigned depth = model.depth(job.node);
    Slice slice = makeLevelSlice(tools_.format, model.lattice, sources, stage_.limits.error,
                                 stage_.level + kRangeLevels - depth);
    slice.node = job.node;
    slice.edgeLog2 = model.lattice.rootCellLog2 - depth;
    return slice;
}

Result<void> LevelApplier::writePages() {
    LevelModel& model = tools_.model;
    const auto add = [&](const NodeRanges& ranges) -> LevelRecord& {
        addBox(model.nodes[ranges.node], model.hasWhole(ranges.node, stage_.level), ranges.box);
        LevelRecord& entry = model.entries[ranges.node].back();
        entry.error =
            std::max(entry.error, static_cast<float>(ranges.error) * (stage_.limits.error / 255.0f));
        return entry;
    };
    return tools_.writer.write(packer_.take(), add, tools_.arena);
}

// Pages before `end` are not needed any more.
void LevelApplier::release(std::uint32_t end) {
    while (!loaded_.empty() && firstLoaded_ < end) {
        loaded_.pop_front();
        ++firstLoaded_;
    }
}

}  // namespace iwalk
