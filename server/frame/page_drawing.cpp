#include "server/frame/page_drawing.hpp"

namespace iwalk {

BlockView::BlockView(const TileView& view, const Block& part)
    : block(part),
      eye(view.eye),
      frustum(frustumOf(view.projection, part.part, 1, view.near)),
      boxes(view.projection, part.part, view.near) {}

std::vector<std::uint32_t> pagesOf(std::span<const VisibleRanges> visible) {
    std::vector<std::uint32_t> pages;
    for (const VisibleRanges& ranges : visible)
        if (pages.empty() || pages.back() != ranges.page) pages.push_back(ranges.page);
    return pages;
}

bool PageDrawing::take(const BlockView& view, std::span<const VisibleRanges>& visible, Page& page,
                       const std::function<void()>& beforeRelease) {
    PageCache::Next next = cache_.next();
    while (next.answer == PageCache::Answer::full) {
        beforeRelease();
        renderer_.finish();
        cache_.release();
        next = cache_.next();
    }
    const bool there = next.answer == PageCache::Answer::page;
    const std::uint32_t number = visible.front().page;
    if (there) CHECK_OP(next.page.page, ==, number);
    page = {next.page, visible.front().rank, {}};
    for (; !visible.empty() && visible.front().page == number; visible = visible.subspan(1))
        if (there)
            cullRanges(*next.page.table, visible.front(), view.frustum, view.boxes, view.eye, page.ranges);
    return there;
}

std::uint32_t PageDrawing::draw(const Page& page, protocol::TileStats& stats) {
    stats.ranges += page.ranges.size();
    for (const DrawnRange& range : page.ranges) stats.triangles += range.indexCount / 3;
    if (drawn_ != nullptr)
        for (const DrawnRange& range : page.ranges)
            drawn_->push_back({page.page.page, range.range, page.page.fetched});
    return renderer_.draw(page.page, hierarchy_.pages[page.page.page], page.rank, page.ranges);
}

void PageDrawing::drawAll(const BlockView& view, std::span<const VisibleRanges> visible,
                          protocol::TileStats& stats) {
    Page page;
    while (!visible.empty())
        if (take(view, visible, page, [] {}) && !page.ranges.empty()) draw(page, stats);
}

}  // namespace iwalk
