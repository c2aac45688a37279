#include "preprocess/levels/apply.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "common/dataset/morph.hpp"
#include "preprocess/build/parallel.hpp"
#include "preprocess/levels/remake.hpp"

namespace iwalk {
namespace {

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
    const std::uint64_t most = tools_.sizes.chunkTriangles;
    for (std::size_t begin = 0, end = 0; begin < jobs.size(); begin = end) {
        std::uint64_t triangles = 0, vertices = 0;
        std::uint32_t lastPage = 0;
        for (; end < jobs.size(); ++end) {
            triangles += jobs[end].triangles, vertices += jobs[end].vertices;
            if (triangles > most || vertices > 2 * most) break;
            lastPage = std::max(lastPage, jobs[end].lastPage);
        }
        if (end == begin) {
            ++end;
            RETURN_IF_ERROR(makeLargeEntry(jobs[begin], needed[end]));
        } else {
            RETURN_IF_ERROR(loadUpTo(lastPage + 1));
            RETURN_IF_ERROR(makeEntries(std::span(jobs).subspan(begin, end - begin)));
        }
        RETURN_IF_ERROR(writePages(packer_.take()));
        release(needed[end]);
        done(static_cast<double>(end) / static_cast<double>(jobs.size()));
    }
    RETURN_IF_ERROR(loadUpTo(static_cast<std::uint32_t>(stage_.changing)));
    packer_.finish();
    return writePages(packer_.take());
}

std::vector<LevelApplier::Job> LevelApplier::planJobs() {
    const LevelModel& model = tools_.model;
    const std::vector<bool> make = keepEntries(tools_.model, stage_, tools_.old);
    std::vector<Job> jobs;
    for (const std::uint32_t node : model.depthFirst()) {
        if (!make[node]) continue;
        Job job{node, model.sourcesOf(node, stage_.level), std::numeric_limits<std::uint32_t>::max(), 0, 0,
                0};
        for (const EntrySource& source : job.sources) {
            job.triangles += source.entry.triangles;
            job.vertices += source.entry.vertices;
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

// With a bound of the error for what vanishes, too.
void LevelApplier::startEntry(const Job& job) {
    LevelRecord entry{};
    entry.level = static_cast<std::uint8_t>(stage_.level);
    for (const EntrySource& source : job.sources) entry.error = std::max(entry.error, source.entry.error);
    tools_.model.entries[job.node].push_back(entry);
}

Result<void> LevelApplier::makeEntries(std::span<const Job> jobs) {
    std::vector<Slice> slices(jobs.size());
    const auto make = [&](std::size_t i) -> Result<void> {
        ASSIGN_OR_RETURN(slices[i], makeSlice(jobs[i]));
        return {};
    };
    const auto add = [&](std::size_t i) -> Result<void> {
        startEntry(jobs[i]);
        packer_.add(std::move(slices[i]));
        return {};
    };
    return orderedFor(tools_.arena, 0, jobs.size(), make, add);
}

Result<Slice> LevelApplier::makeSlice(const Job& job) {
    std::vector<LevelSource> sources;
    std::vector<std::shared_ptr<const SourcePage>> held;
    for (const JobPage& page : pagesOf(job)) {
        ASSIGN_OR_RETURN(sources.emplace_back(), sourceOf(page, held.emplace_back()));
    }
    Slice slice =
        makeLevelSlice(tools_.format, tools_.model.lattice, sources, stage_.limits.error, leastLevels(job));
    place(slice, job);
    return slice;
}

// Goes over its pages once, however many they are. `needed`: the first page that later jobs need.
Result<void> LevelApplier::makeLargeEntry(const Job& job, std::uint32_t needed) {
    const std::vector<JobPage> pages = pagesOf(job);
    // The first page that the job needs from here on.
    std::vector<std::uint32_t> first(pages.size() + 1, needed);
    const auto placeOf = [&](std::size_t i) { return stage_.places.at(pages[i].number); };
    for (std::size_t i = pages.size(); i-- > 0;)
        first[i] = pages[i].held ? first[i + 1] : std::min(first[i + 1], placeOf(i));
    LargeEntry entry(tools_.spill, tools_.format);
    std::vector<SourceImage> images(pages.size());
    const auto make = [&](std::size_t i) -> Result<void> {
        std::shared_ptr<const SourcePage> held;
        ASSIGN_OR_RETURN(const LevelSource source, sourceOf(pages[i], held));
        RangeImages ranges(tools_.format, tools_.model.lattice, stage_.limits.error);
        images[i] = imageOf(source, ranges);
        return {};
    };
    const auto add = [&](std::size_t i) { return entry.add(std::exchange(images[i], {})); };
    for (std::size_t begin = 0, end = 0; begin < pages.size(); begin = end) {
        std::uint64_t vertices = 0;
        std::uint32_t upTo = 0;
        for (; end < pages.size() && vertices <= 2 * tools_.sizes.chunkTriangles; ++end) {
            vertices += stage_.pages[placeOf(end)].record.vertexCount;
            if (!pages[end].held) upTo = std::max(upTo, placeOf(end) + 1);
        }
        RETURN_IF_ERROR(loadUpTo(upTo));
        RETURN_IF_ERROR(orderedFor(tools_.arena, begin, end, make, add));
        release(first[end]);
    }
    RETURN_IF_ERROR(entry.finish(packer_.mostTriangles(), leastLevels(job)));
    return writeLargeEntry(job, entry);
}

Result<void> LevelApplier::writeLargeEntry(const Job& job, LargeEntry& entry) {
    startEntry(job);
    if (entry.pages() == 1) {  // little is left of it
        ASSIGN_OR_RETURN(Slice slice, entry.next());
        place(slice, job);
        packer_.add(std::move(slice));
        return {};
    }
    packer_.finish();
    RETURN_IF_ERROR(writePages(packer_.take()));
    const std::size_t atOnce = 4 * static_cast<std::size_t>(tools_.arena.max_concurrency());
    for (std::size_t left = entry.pages(); left > 0;) {
        std::vector<PageJob> pages;
        for (; pages.size() < atOnce && left > 0; --left) {
            ASSIGN_OR_RETURN(Slice slice, entry.next());
            place(slice, job);
            pages.emplace_back().slices.push_back(std::move(slice));
        }
        RETURN_IF_ERROR(writePages(std::move(pages)));
    }
    return {};
}

std::vector<LevelApplier::JobPage> LevelApplier::pagesOf(const Job& job) const {
    std::vector<JobPage> pages;
    for (const EntrySource& source : job.sources) {
        const LevelRecord& entry = source.entry;
        for (std::uint32_t number = entry.firstPage; number < entry.firstPage + entry.pageCount; ++number) {
            const bool shared = entry.pageCount == 1;
            pages.push_back({number, shared ? entry.firstRange : 0u,
                             shared ? entry.rangeCount : tools_.writer.records()[number].rangeCount,
                             source.held, source.way, source.wayLevels});
        }
    }
    return pages;
}

// `held` keeps a page that is not among those loaded.
Result<LevelSource> LevelApplier::sourceOf(const JobPage& page, std::shared_ptr<const SourcePage>& held) {
    LevelSource source{nullptr, nullptr, page.firstRange, page.rangeCount, page.way, page.wayLevels};
    const std::uint32_t place = stage_.places.at(page.number);
    if (page.held) {
        ASSIGN_OR_RETURN(held, tools_.store.get(page.number, stage_.pages[place].record));
        source.page = held.get();
    } else {
        const Loaded& loaded = loaded_[place - firstLoaded_];
        source.page = loaded.page.get();
        source.targets = &loaded.targets;
    }
    return source;
}

void LevelApplier::place(Slice& slice, const Job& job) const {
    slice.node = job.node;
    slice.edgeLog2 = tools_.model.lattice.rootCellLog2 - tools_.model.depth(job.node);
}

unsigned LevelApplier::leastLevels(const Job& job) const {
    return stage_.level + kRangeLevels - tools_.model.depth(job.node);
}

Result<void> LevelApplier::writePages(std::vector<PageJob> pages) {
    LevelModel& model = tools_.model;
    const auto add = [&](const NodeRanges& ranges) -> LevelRecord& {
        addBox(model.nodes[ranges.node], model.hasWhole(ranges.node, stage_.level), ranges.box);
        LevelRecord& entry = model.entries[ranges.node].back();
        entry.error =
            std::max(entry.error, static_cast<float>(ranges.error) * (stage_.limits.error / 255.0f));
        return entry;
    };
    return tools_.writer.write(std::move(pages), add, tools_.arena);
}

// Pages before `end` are not needed any more.
void LevelApplier::release(std::uint32_t end) {
    while (!loaded_.empty() && firstLoaded_ < end) {
        loaded_.pop_front();
        ++firstLoaded_;
    }
}

}  // namespace iwalk
