#include "server/frame/conservative.hpp"

#include <algorithm>

#include "server/frame/tile_counters.hpp"

namespace iwalk {
namespace {

// Without a last frame the nearest pages are the guess, up to so many triangles.
constexpr std::uint64_t kFirstGuess = 100'000;
// So many triangles beyond the guess make another look at the depth worth while.
constexpr std::uint64_t kLookAgain = 200'000;
// Pages that are asked for together: more let fetch threads read ahead, fewer leave more unread that the next
// look finds hidden.
constexpr std::size_t kPagesTogether = 16;

}  // namespace

void ConservativeDrawing::drawBlock(const BlockView& view, std::span<const VisibleRanges> candidates,
                                    protocol::TileStats& stats) {
    draws_.clear();
    drawn_.clear();
    const std::vector<VisibleRanges> guess = guessAmong(candidates);
    cache_.beginFrame(pagesOf(guess));
    renderer_.beginBlock(view.block);
    drawGuess(view, guess, stats);
    look(stats);
    renderer_.beginRest();
    const std::size_t done = guess_.empty() ? guess.size() : 0;
    drawRest(view, {candidates.begin() + static_cast<std::ptrdiff_t>(done), candidates.end()}, stats);
    renderer_.finish();
    Stopwatch watch;
    remember();
    stats.testMs += watch.lap();
}

// What of the last frame's ranges is among the candidates, in their order.
std::vector<VisibleRanges> ConservativeDrawing::guessAmong(std::span<const VisibleRanges> candidates) const {
    std::vector<VisibleRanges> guess;
    if (guess_.empty()) {
        std::uint64_t triangles = 0;
        for (const VisibleRanges& ranges : candidates) {
            if (triangles >= kFirstGuess) break;
            triangles += visibility_.trianglesOf(ranges);
            guess.push_back(ranges);
        }
        return guess;
    }
    for (const VisibleRanges& ranges : candidates) {
        auto known =
            std::lower_bound(guess_.begin(), guess_.end(), PageRange(ranges.page, ranges.firstRange));
        const PageRange end(ranges.page, ranges.firstRange + ranges.rangeCount);
        for (; known != guess_.end() && *known < end; ++known) {
            const bool next = !guess.empty() && guess.back().page == ranges.page &&
                              guess.back().firstRange + guess.back().rangeCount == known->second;
            if (next)
                ++guess.back().rangeCount;
            else
                guess.push_back({ranges.page, known->second, 1, ranges.rank});
        }
    }
    return guess;
}

void ConservativeDrawing::drawGuess(const BlockView& view, std::span<const VisibleRanges> guess,
                                    protocol::TileStats& stats) {
    Stopwatch watch;
    const std::uint64_t before = stats.triangles;
    PageDrawing::Page page;
    while (!guess.empty())
        if (pages_.take(view, guess, page, [] {})) draw(page, stats);
    renderer_.wait();
    stats.guessMs += watch.lap();
    stats.guessTriangles += stats.triangles - before;
}

void ConservativeDrawing::draw(const PageDrawing::Page& page, protocol::TileStats& stats) {
    if (page.ranges.empty()) return;
    const std::uint32_t number = pages_.draw(page, stats);
    draws_.resize(number + 1);
    draws_[number] = {page.page.page, drawn_.size()};
    drawn_.insert(drawn_.end(), page.ranges.begin(), page.ranges.end());
}

void ConservativeDrawing::look(protocol::TileStats& stats) {
    renderer_.wait();
    Stopwatch watch;
    occlusion_->update();
    stats.pyramidMs += watch.lap();
}

// From near to far, looking again when much has been drawn.
void ConservativeDrawing::drawRest(const BlockView& view, std::vector<VisibleRanges> open,
                                   protocol::TileStats& stats) {
    std::size_t from = 0;
    hidePages(view, open, from, stats);
    std::uint64_t lastLook = stats.triangles;
    while (from < open.size()) {
        if (stats.triangles - lastLook >= kLookAgain) {
            look(stats);
            lastLook = stats.triangles;
            hidePages(view, open, from, stats);
        }
        std::size_t end = std::min(open.size(), from + kPagesTogether);
        while (end < open.size() && open[end].page == open[end - 1].page) ++end;
        drawSome(view, std::span(open).subspan(from, end - from), stats);
        from = end;
    }
}

void ConservativeDrawing::hidePages(const BlockView& view, std::vector<VisibleRanges>& open, std::size_t from,
                                    protocol::TileStats& stats) {
    Stopwatch watch;
    boxes_.clear();
    for (std::size_t i = from; i < open.size(); ++i) {
        const LatticeBox& box = visibility_.pageBox(open[i].page);
        boxes_.push_back(view.boxes.of(view.eye.to(box.min), view.eye.to(box.max)));
    }
    occlusion_->hidden(boxes_, hidden_);
    std::size_t kept = from;
    for (std::size_t i = from; i < open.size(); ++i)
        if (!hidden_[i - from]) open[kept++] = open[i];
    stats.hiddenPages += open.size() - kept;
    open.resize(kept);
    stats.testMs += watch.lap();
}

void ConservativeDrawing::drawSome(const BlockView& view, std::span<const VisibleRanges> some,
                                   protocol::TileStats& stats) {
    cache_.continueFrame(pagesOf(some));
    std::vector<PageDrawing::Page> open;
    PageDrawing::Page page;
    while (!some.empty()) {
        if (!pages_.take(view, some, page, [&] { drawOpen(open, stats); })) continue;
        removeGuessed(page);
        open.push_back(std::move(page));
    }
    drawOpen(open, stats);
}

// Ranges of the guess are drawn already.
void ConservativeDrawing::removeGuessed(PageDrawing::Page& page) const {
    auto known = std::lower_bound(guess_.begin(), guess_.end(), PageRange(page.page.page, 0));
    std::erase_if(page.ranges, [&](const DrawnRange& range) {
        const PageRange that(page.page.page, range.range);
        while (known != guess_.end() && *known < that) ++known;
        return known != guess_.end() && *known == that;
    });
}

void ConservativeDrawing::drawOpen(std::vector<PageDrawing::Page>& open, protocol::TileStats& stats) {
    Stopwatch watch;
    boxes_.clear();
    for (const PageDrawing::Page& page : open)
        for (const DrawnRange& range : page.ranges) boxes_.push_back(range.box);
    occlusion_->hidden(boxes_, hidden_);
    auto answer = hidden_.begin();
    for (PageDrawing::Page& page : open)
        stats.hiddenRanges += std::erase_if(page.ranges, [&](const DrawnRange&) { return *answer++; });
    stats.testMs += watch.lap();
    for (const PageDrawing::Page& page : open) draw(page, stats);
    open.clear();
}

// The ranges that own a pixel.
void ConservativeDrawing::remember() {
    renderer_.readBlockTriangles(pixels_);
    std::uint32_t last = 0;
    std::vector<bool> owns(drawn_.size());
    for (const std::uint32_t pixel : pixels_) {
        if (pixel == last || pixel == 0) continue;
        last = pixel;
        const std::size_t number = (pixel >> 16) - 1;
        const std::size_t first = draws_[number].firstRange;
        const std::size_t end = number + 1 < draws_.size() ? draws_[number + 1].firstRange : drawn_.size();
        const std::uint32_t index = 3 * (pixel & 0xffff);
        const auto behind =
            std::upper_bound(drawn_.begin() + static_cast<std::ptrdiff_t>(first),
                             drawn_.begin() + static_cast<std::ptrdiff_t>(end), index,
                             [](std::uint32_t i, const DrawnRange& range) { return i < range.firstIndex; });
        const auto range = static_cast<std::size_t>(behind - drawn_.begin()) - 1;
        if (owns[range]) continue;
        owns[range] = true;
        seen_.emplace_back(draws_[number].page, drawn_[range].range);
    }
}

void ConservativeDrawing::endFrame() {
    std::sort(seen_.begin(), seen_.end());
    seen_.erase(std::unique(seen_.begin(), seen_.end()), seen_.end());
    guess_.swap(seen_);
    seen_.clear();
}

}  // namespace iwalk
