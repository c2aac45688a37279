#pragma once

#include <deque>
#include <unordered_map>
#include <vector>

#include "common/settings.hpp"
#include "server/frame/page_drawing.hpp"
#include "server/visibility/plp_spending.hpp"
#include "server/visibility/plp_visibility.hpp"

namespace iwalk {

// What one tile draws in `--mode plp`, from frame to frame: keeps the range tables of the last frame's
// candidates, so that a page need not be read again to know that it is not drawn.
class PlpFrame {
  public:
    // All outlive it.
    PlpFrame(const Hierarchy& hierarchy, const FrustumVisibility& frustum, PageCache& cache,
             Renderer& renderer, PageDrawing& pages, Workers& workers, const Settings& settings);

    // Begins a frame: finds what is worth drawing, and what each block may spend. Takes the pages of
    // candidates from the cache where it does not know their tables, between two frames of its. The result is
    // the blocks that are to be drawn: those of mode frustum when the budget suffices for all.
    std::vector<BlockView> begin(const Cut& cut, const TileView& view, protocol::TileStats& stats);

    // The frame's next block, from beginning it to its pixels.
    void drawBlock(const BlockView& view, protocol::TileStats& stats);

  private:
    void readTables(const std::vector<std::uint32_t>& pages, protocol::TileStats& stats);
    void shareBudget(std::span<const BlockView> blocks);
    std::vector<PlpSpending::Range> rangesIn(const BlockView& view) const;
    std::vector<VisibleRanges> take(PlpSpending& spending, const LatticeEye& eye);

    const std::uint64_t budget_;
    const PlpVisibility plp_;
    const FrustumVisibility& frustum_;
    PageCache& cache_;
    Renderer& renderer_;
    PageDrawing& pages_;
    Workers& workers_;

    std::unordered_map<std::uint32_t, PageTable> tables_;  // by page
    // Of the frame: its ranges by priority, which of them are drawn somewhere, what blocks may spend.
    std::vector<PlpRange> ranges_;
    std::vector<bool> drawn_;
    std::deque<std::uint64_t> budgets_;
    DepthPyramid pyramid_;  // scratch
};

}  // namespace iwalk
