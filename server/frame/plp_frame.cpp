#include "server/frame/plp_frame.hpp"

#include <algorithm>
#include <cmath>

#include "server/frame/tile_counters.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kTogether = 256;  // ranges that a thread projects at a time

}  // namespace

PlpFrame::PlpFrame(const Hierarchy& hierarchy, const FrustumVisibility& frustum, PageCache& cache,
                   Renderer& renderer, PageDrawing& pages, Workers& workers, const Settings& settings)
    : budget_(settings.plpBudget),
      plp_(hierarchy, settings.plpBudget, settings.plpRays / 100, workers),
      frustum_(frustum),
      cache_(cache),
      renderer_(renderer),
      pages_(pages),
      workers_(workers) {}

std::vector<BlockView> PlpFrame::begin(const Cut& cut, const TileView& view, protocol::TileStats& stats) {
    Stopwatch watch;
    const TileSight sight{view.projection, view.tile, view.eye, view.near};
    const std::vector<PlpVisibility::Candidate> candidates = plp_.candidates(cut, sight);
    const std::vector<std::uint32_t> pages = plp_.pagesOf(candidates);
    stats.visibilityMs += watch.lap();

    readTables(pages, stats);
    watch.lap();

    const auto tableOf = [&](std::uint32_t page) {
        const auto found = tables_.find(page);
        return found == tables_.end() ? nullptr : &found->second;
    };
    ranges_ = plp_.ranges(candidates, tableOf, sight);
    drawn_.assign(ranges_.size(), false);
    std::uint64_t triangles = 0;
    for (const PlpRange& range : ranges_) triangles += range.triangles;
    std::vector<BlockView> blocks;
    for (const Block& block : triangles <= budget_ ? blocksOf(view.tile) : ownBlocksOf(view.tile))
        blocks.emplace_back(view, block);
    shareBudget(blocks);
    stats.visibilityMs += watch.lap();
    return blocks;
}

void PlpFrame::readTables(const std::vector<std::uint32_t>& pages, protocol::TileStats& stats) {
    std::unordered_map<std::uint32_t, PageTable> tables;
    std::vector<std::uint32_t> unknown;
    for (const std::uint32_t page : pages) {
        if (auto known = tables_.extract(page))
            tables.insert(std::move(known));
        else
            unknown.push_back(page);
    }
    tables_ = std::move(tables);
    if (unknown.empty()) return;

    cache_.beginFrame(unknown);
    for (PageCache::Next next = cache_.next(); next.answer != PageCache::Answer::end; next = cache_.next()) {
        if (next.answer == PageCache::Answer::page) tables_[next.page.page] = *next.page.table;
        if (next.answer == PageCache::Answer::full) cache_.release();
    }
    cache_.release();
    addCounters(cache_.counters(), stats);
}

// As rays would spend it: each block has what the first choice has in it and in no block before it.
void PlpFrame::shareBudget(std::span<const BlockView> blocks) {
    budgets_.assign(blocks.size(), 0);
    if (blocks.size() == 1) {
        budgets_.front() = budget_;
        return;
    }
    std::uint64_t left = budget_;
    for (const PlpRange& range : ranges_) {
        if (range.triangles > left) continue;
        left -= range.triangles;
        const auto first = std::find_if(blocks.begin(), blocks.end(), [&](const BlockView& view) {
            return !view.boxes.of(glm::dvec3(range.box.low), glm::dvec3(range.box.high)).empty();
        });
        if (first != blocks.end())
            budgets_[static_cast<std::size_t>(first - blocks.begin())] += range.triangles;
    }
    budgets_.front() += left;
}

void PlpFrame::drawBlock(const BlockView& view, protocol::TileStats& stats) {
    Stopwatch watch;
    PlpSpending spending(rangesIn(view), budgets_.front());
    budgets_.pop_front();
    std::vector<VisibleRanges> next = take(spending, view.eye);
    stats.visibilityMs += watch.lap();

    cache_.beginFrame(pagesOf(next));
    renderer_.beginBlock(view.block);
    pages_.drawAll(view, next, stats);
    while (!spending.done()) {
        renderer_.wait();
        watch.lap();
        renderer_.readBlockDepths(pyramid_);
        stats.pyramidMs += watch.lap();
        stats.hiddenRanges += spending.look(pyramid_, workers_);
        next = take(spending, view.eye);
        stats.testMs += watch.lap();
        cache_.continueFrame(pagesOf(next));
        pages_.drawAll(view, next, stats);
    }
    renderer_.finish();
    if (!budgets_.empty()) budgets_.front() += spending.left();
}

std::vector<PlpSpending::Range> PlpFrame::rangesIn(const BlockView& view) const {
    std::vector<PlpSpending::Range> ranges(ranges_.size());
    workers_.runParts(ranges_.size(), kTogether, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
            const PlpRange& range = ranges_[i];
            const ScreenBox box = view.boxes.of(glm::dvec3(range.box.low), glm::dvec3(range.box.high));
            ranges[i] = {static_cast<std::uint32_t>(i), drawn_[i] ? 0 : range.triangles, box};
        }
    });
    std::erase_if(ranges, [](const PlpSpending::Range& range) { return range.box.empty(); });
    return ranges;
}

std::vector<VisibleRanges> PlpFrame::take(PlpSpending& spending, const LatticeEye& eye) {
    std::vector<VisibleRanges> taken;
    for (const PlpSpending::Taken& t : spending.step()) {
        const PlpRange& range = ranges_[t.number];
        drawn_[t.number] = true;
        // By the square root of what was spent before, since the first ones have most of the pixels.
        const auto turn = static_cast<std::uint8_t>(kTurns * std::sqrt(t.spent));
        taken.push_back({range.page, range.range, 1, 0, std::min<std::uint8_t>(turn, kTurns - 1)});
    }
    std::vector<VisibleRanges> visible = joined(std::move(taken));
    frustum_.sortFrontToBack(visible, eye);
    return visible;
}

}  // namespace iwalk
