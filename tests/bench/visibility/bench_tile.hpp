#pragma once

#include <optional>

#include "server/frame/conservative.hpp"
#include "server/frame/tile_pipeline.hpp"

namespace iwalk::bench {

enum class Method { frustum, hzb, queries, items };

// One tile and what draws it, all pages resident after the first time. Errors end the program.
class BenchTile {
  public:
    // The dataset outlives it.
    BenchTile(const Dataset& dataset, const PixelRect& rect, Method method, unsigned threads);

    // Return when the pixels are there; drawMs is the time of the whole frame.
    protocol::TileStats draw(const TileView& view);
    protocol::TileStats drawRanges(const TileView& view, std::span<const VisibleRanges> ranges);
    protocol::TileStats drawPacked(const TileView& view);

    // After drawRanges() of everything: the ranges that the frame's own depth does not hide, exact to the
    // pixel; and the triangles that own a pixel, packed into pages of their own in another tile's memory for
    // its drawPacked(). That tile draws nothing else.
    std::vector<VisibleRanges> notHidden(const TileView& view);
    void packOwners(BenchTile& into);

    std::vector<VisibleRanges> inFrustum(const TileView& view) const;

  private:
    template <class Fill>
    protocol::TileStats timed(const TileView& view, Fill fill);

    const Dataset& dataset_;
    const Cut cut_;
    const FrustumVisibility visibility_;
    Workers workers_;
    std::unique_ptr<TilePixels> pixels_;
    std::unique_ptr<Renderer> renderer_;
    std::vector<std::span<std::byte>> memory_;
    std::unique_ptr<PageCache> cache_;
    std::optional<PageDrawing> pages_;
    std::unique_ptr<Occlusion> occlusion_;
    std::optional<ConservativeDrawing> conservative_;
    std::vector<ResidentPage> drawn_;  // by number of the draw, of drawRanges()
    struct Packed {
        PageRecord record;
        PageTable table;
        ArenaPlace place;
    };
    std::vector<Packed> packed_;
};

}  // namespace iwalk::bench
