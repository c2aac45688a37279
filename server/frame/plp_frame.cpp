#include "server/frame/plp_frame.hpp"

#include <algorithm>

#include "server/frame/tile_counters.hpp"

namespace iwalk {

PlpFrame::PlpFrame(const Hierarchy& hierarchy, const FrustumVisibility& frustum, const Settings& settings)
    : plp_(hierarchy, frustum, settings.plpBudget, settings.plpRays / 100) {}

void PlpFrame::choose(const Cut& cut, const TileSight& sight, PageCache& cache, protocol::TileStats& stats) {
    Stopwatch watch;
    const std::vector<PlpVisibility::Candidate> candidates = plp_.candidates(cut, sight);
    const std::vector<std::uint32_t> pages = plp_.pagesOf(candidates);
    stats.visibilityMs += watch.lap();

    readTables(pages, cache, stats);
    watch.lap();

    const auto tableOf = [&](std::uint32_t page) {
        const auto found = tables_.find(page);
        return found == tables_.end() ? nullptr : &found->second;
    };
    chosen_ = plp_.choose(candidates, tableOf, sight);
    stats.visibilityMs += watch.lap();
}

void PlpFrame::readTables(const std::vector<std::uint32_t>& pages, PageCache& cache,
                          protocol::TileStats& stats) {
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

    cache.beginFrame(unknown);
    for (PageCache::Next next = cache.next(); next.answer != PageCache::Answer::end; next = cache.next()) {
        if (next.answer == PageCache::Answer::page) tables_[next.page.page] = *next.page.table;
        if (next.answer == PageCache::Answer::full) cache.release();
    }
    cache.release();
    addCounters(cache.counters(), stats);
}

std::vector<VisibleRanges> PlpFrame::visible(const Frustum& frustum, const LatticeEye& eye) const {
    std::vector<VisibleRanges> visible = chosen_;
    std::erase_if(visible, [&](const VisibleRanges& ranges) {
        bool any = false;
        forRangesIn(tables_.at(ranges.page), ranges.firstRange, ranges.rangeCount, frustum, eye,
                    [&](std::uint32_t, const glm::dvec3&, const glm::dvec3&) { any = true; });
        return !any;
    });
    return visible;
}

}  // namespace iwalk
