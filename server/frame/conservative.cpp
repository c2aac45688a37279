#include "server/frame/conservative.hpp"

#include <algorithm>

#include "server/frame/tile_counters.hpp"

namespace iwalk {
namespace {

// Without a last frame the nearest pages are the guess, up to so many triangles, and up to half of all: what
// is drawn before the look is not found to be hidden.
constexpr std::uint64_t kFirstGuess = 100'000;
// So many triangles beyond the guess make another look at the depth worth while: at first few, since the
// guess may have been bad, then twice as many each time, up to the most.
constexpr std::uint64_t kLookAgain = 50'000, kLookAgainAtMost = 200'000;
// Pages that are asked for together: more let fetch threads read ahead, fewer leave more unread that the next
// look finds hidden.
constexpr std::size_t kPagesTogether = 16;

}  // namespace

void ConservativeDrawing::drawBlock(const BlockView& view, std::span<const VisibleRanges> candidates,
                                    protocol::TileStats& stats) {
    memory_ = &memories_[{view.block.x, view.block.y}];
    const auto pixels = static_cast<double>(view.block.part.width) * view.block.part.height;
    std::uint64_t triangles = 0;
    for (const VisibleRanges& ranges : candidates) triangles += visibility_.trianglesOf(ranges);
    if (!memory_->looking.pays(static_cast<double>(triangles), costOfLooking_ * pixels))
        return drawAll(view, candidates, stats);
    drawSeen(view, candidates, std::min(kFirstGuess, triangles / 2), stats);
    memory_->looking.looked(static_cast<double>(hiddenTriangles_), static_cast<double>(triangles),
                            costOfLooking_ * pixels);
}

void ConservativeDrawing::drawAll(const BlockView& view, std::span<const VisibleRanges> candidates,
                                  protocol::TileStats& stats) {
    cache_.beginFrame(pagesOf(candidates));
    renderer_.beginBlock(view.block);
    pages_.drawAll(view, candidates, stats);
    renderer_.finish();
}

void ConservativeDrawing::drawSeen(const BlockView& view, std::span<const VisibleRanges> candidates,
                                   std::uint64_t firstGuess, protocol::TileStats& stats) {
    draws_.clear();
    drawn_.clear();
    hiddenTriangles_ = 0;
    rest_ = false;
    const std::vector<VisibleRanges> guess = guessAmong(candidates, firstGuess);
    cache_.beginFrame(pagesOf(guess));
    renderer_.beginBlock(view.block);
    drawGuess(view, guess, stats);
    look(stats);
    const std::size_t done = memory_->guess.empty() ? guess.size() : 0;
    drawRest(view, {candidates.begin() + static_cast<std::ptrdiff_t>(done), candidates.end()}, stats);
    renderer_.finish();
    Stopwatch watch;
    remember();
    stats.testMs += watch.lap();
}

// What of the last frame's ranges is among the candidates, in their order.
std::vector<VisibleRanges> ConservativeDrawing::guessAmong(std::span<const VisibleRanges> candidates,
                                                           std::uint64_t firstGuess) const {
    const std::vector<PageRange>& seen = memory_->guess;
    std::vector<VisibleRanges> guess;
    if (seen.empty()) {
        std::uint64_t triangles = 0;
        for (const VisibleRanges& ranges : candidates) {
            if (triangles >= firstGuess) break;
            triangles += visibility_.trianglesOf(ranges);
            guess.push_back(ranges);
        }
        return guess;
    }
    for (const VisibleRanges& ranges : candidates) {
        auto known = std::lower_bound(seen.begin(), seen.end(), PageRange(ranges.page, ranges.firstRange));
        const PageRange end(ranges.page, ranges.firstRange + ranges.rangeCount);
        for (; known != seen.end() && *known < end; ++known) {
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
    occlusion_.update();
    stats.pyramidMs += watch.lap();
}

// From near to far, looking again when much has been drawn.
void ConservativeDrawing::drawRest(const BlockView& view, std::vector<VisibleRanges> open,
                                   protocol::TileStats& stats) {
    std::size_t from = 0;
    hidePages(view, open, from, stats);
    std::uint64_t lastLook = stats.triangles, lookAgain = kLookAgain;
    while (from < open.size()) {
        if (stats.triangles - lastLook >= lookAgain) {
            look(stats);
            lastLook = stats.triangles;
            lookAgain = std::min(2 * lookAgain, kLookAgainAtMost);
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
    occlusion_.hidden(boxes_, hidden_);
    std::size_t kept = from;
    for (std::size_t i = from; i < open.size(); ++i) {
        if (hidden_[i - from])
            hiddenTriangles_ += visibility_.trianglesOf(open[i]);
        else
            open[kept++] = open[i];
    }
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
    const std::vector<PageRange>& guess = memory_->guess;
    auto known = std::lower_bound(guess.begin(), guess.end(), PageRange(page.page.page, 0));
    std::erase_if(page.ranges, [&](const DrawnRange& range) {
        const PageRange that(page.page.page, range.range);
        while (known != guess.end() && *known < that) ++known;
        return known != guess.end() && *known == that;
    });
}

void ConservativeDrawing::drawOpen(std::vector<PageDrawing::Page>& open, protocol::TileStats& stats) {
    Stopwatch watch;
    boxes_.clear();
    for (const PageDrawing::Page& page : open)
        for (const DrawnRange& range : page.ranges) boxes_.push_back(range.box);
    occlusion_.hidden(boxes_, hidden_);
    auto answer = hidden_.begin();
    for (PageDrawing::Page& page : open)
        stats.hiddenRanges += std::erase_if(page.ranges, [&](const DrawnRange& range) {
            if (*answer) hiddenTriangles_ += range.indexCount / 3;
            return *answer++;
        });
    stats.testMs += watch.lap();
    for (const PageDrawing::Page& page : open) {
        if (!page.ranges.empty() && !rest_) renderer_.beginRest();
        rest_ = rest_ || !page.ranges.empty();
        draw(page, stats);
    }
    open.clear();
}

// The ranges that own a pixel are the next frame's guess.
void ConservativeDrawing::remember() {
    // A pixel's number is that of the draw and of the triangle in its page: those of a range stand together,
    // in the order of drawing.
    firstNumbers_.clear();
    std::vector<PageRange> ranges;
    for (std::size_t number = 0; number < draws_.size(); ++number) {
        const Draw& draw = draws_[number];
        const std::size_t end = number + 1 < draws_.size() ? draws_[number + 1].firstRange : drawn_.size();
        for (std::size_t i = draw.firstRange; i < end; ++i) {
            ranges.emplace_back(draw.page, drawn_[i].range);
            firstNumbers_.push_back(static_cast<std::uint32_t>((number + 1) << 16) |
                                    drawn_[i].firstIndex / 3);
        }
    }
    const std::size_t count = ranges.size();
    firstNumbers_.push_back(0xffffffff);  // behind the last one

    renderer_.readBlockTriangles(pixels_);
    std::vector<bool> owns(count);
    std::uint32_t first = 0, size = 1;  // of the range of the last pixel; at first nobody's
    for (const std::uint32_t pixel : pixels_) {
        if (pixel - first < size || pixel == 0) continue;
        const auto next = std::upper_bound(firstNumbers_.begin(), firstNumbers_.end(), pixel);
        owns[static_cast<std::size_t>(next - firstNumbers_.begin()) - 1] = true;
        first = *(next - 1);
        size = *next - first;
    }
    memory_->guess.clear();
    for (std::size_t i = 0; i < count; ++i)
        if (owns[i]) memory_->guess.push_back(ranges[i]);
    std::sort(memory_->guess.begin(), memory_->guess.end());
}

}  // namespace iwalk
