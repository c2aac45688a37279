#pragma once

#include <functional>

#include "common/protocol.hpp"
#include "server/cache/page_cache.hpp"
#include "server/draw/renderer.hpp"

namespace iwalk {

// One block of one view, as culling needs it.
struct BlockView {
    BlockView(const TileView& view, const Block& part);

    const Block block;
    const LatticeEye eye;
    const Frustum frustum;  // a pixel wider than the block: snapping moves vertices by less
    const BoxProjection boxes;
};

// The pages of a list, each once, in its order.
std::vector<std::uint32_t> pagesOf(std::span<const VisibleRanges> visible);

// Takes the pages that the cache was told of, finds what of them may be seen, and has it drawn.
class PageDrawing {
  public:
    PageDrawing(const Hierarchy& hierarchy, PageCache& cache, Renderer& renderer)
        : hierarchy_(hierarchy), cache_(cache), renderer_(renderer) {}

    // A page that is there, and what of it may be seen.
    struct Page {
        ResidentPage page;
        std::uint32_t rank = 0;  // VisibleRanges::rank
        std::vector<DrawnRange> ranges;
    };
    // Waits for the page whose ranges `visible` begins with, and takes them away from it. False when the page
    // cannot be read. Before pages that were taken are given back, because they hold all the memory,
    // `beforeRelease` is called: what is not drawn then cannot be drawn any more.
    bool take(const BlockView& view, std::span<const VisibleRanges>& visible, Page& page,
              const std::function<void()>& beforeRelease);

    // From here on what is drawn is noted there, too; nullptr: no longer.
    struct Drawn {
        std::uint32_t page, range;
        bool fetched;  // the page was read for it
    };
    void noteInto(std::vector<Drawn>* drawn) { drawn_ = drawn; }

    // The result is the draw's number in the block.
    std::uint32_t draw(const Page& page, protocol::TileStats& stats);

    // Takes and draws all of `visible`.
    void drawAll(const BlockView& view, std::span<const VisibleRanges> visible, protocol::TileStats& stats);

  private:
    const Hierarchy& hierarchy_;
    PageCache& cache_;
    Renderer& renderer_;
    std::vector<Drawn>* drawn_ = nullptr;
};

}  // namespace iwalk
