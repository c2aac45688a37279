#pragma once

#include <map>
#include <utility>

#include "server/draw/occlusion.hpp"
#include "server/frame/page_drawing.hpp"
#include "server/visibility/looking.hpp"

namespace iwalk {

// Conservative visibility (`--mode cplp`): all that can be seen is drawn, and little else. After GigaWalk,
// section 5, and Correa, section 4.3: what was seen in the last frame is drawn first; of everything else that
// the frustum has only what the depth of that does not hide. Pages that are hidden as a whole are not even
// read. The picture is that of drawing everything, in every bit (docs/architecture.md, "Hidden is hidden").
// Where finding out costs more than it spares, everything is drawn.
class ConservativeDrawing {
  public:
    // What finding out costs, in triangles drawn for each pixel of a block: less than that need not be
    // spared. Tests set it to 0 to have small scenes looked at.
    static constexpr double kCostOfLooking = 0.05;

    // All outlive it.
    ConservativeDrawing(const FrustumVisibility& visibility, PageCache& cache, Renderer& renderer,
                        PageDrawing& pages, Occlusion& occlusion, double costOfLooking)
        : costOfLooking_(costOfLooking),
          visibility_(visibility),
          cache_(cache),
          renderer_(renderer),
          pages_(pages),
          occlusion_(occlusion) {}

    // From beginning the block to its pixels. `candidates`: everything in the block's frustum, from near to
    // far.
    void drawBlock(const BlockView& view, std::span<const VisibleRanges> candidates,
                   protocol::TileStats& stats);

  private:
    using PageRange = std::pair<std::uint32_t, std::uint32_t>;  // page, range in the page
    // What is known of a block from frame to frame.
    struct Memory {
        std::vector<PageRange> guess;  // what owned a pixel when it was last looked; sorted
        Looking looking;
    };
    void drawAll(const BlockView& view, std::span<const VisibleRanges> candidates,
                 protocol::TileStats& stats);
    void drawSeen(const BlockView& view, std::span<const VisibleRanges> candidates, std::uint64_t firstGuess,
                  protocol::TileStats& stats);
    struct Draw {
        std::uint32_t page;
        std::size_t firstRange;  // in drawn_
    };
    std::vector<VisibleRanges> guessAmong(std::span<const VisibleRanges> candidates,
                                          std::uint64_t firstGuess) const;
    void look(protocol::TileStats& stats);
    void drawGuess(const BlockView& view, std::span<const VisibleRanges> guess, protocol::TileStats& stats);
    void drawRest(const BlockView& view, std::vector<VisibleRanges> open, protocol::TileStats& stats);
    void hidePages(const BlockView& view, std::vector<VisibleRanges>& open, std::size_t from,
                   protocol::TileStats& stats);
    void drawSome(const BlockView& view, std::span<const VisibleRanges> some, protocol::TileStats& stats);
    void drawOpen(std::vector<PageDrawing::Page>& open, protocol::TileStats& stats);
    void draw(const PageDrawing::Page& page, protocol::TileStats& stats);
    void removeGuessed(PageDrawing::Page& page) const;
    void remember();

    const double costOfLooking_;
    const FrustumVisibility& visibility_;
    PageCache& cache_;
    Renderer& renderer_;
    PageDrawing& pages_;
    Occlusion& occlusion_;

    std::map<std::pair<int, int>, Memory> memories_;  // by the block's corner
    Memory* memory_ = nullptr;                        // of the block
    // Of the block: its draws by number, and their ranges; what of its triangles was hidden.
    std::vector<Draw> draws_;
    std::vector<DrawnRange> drawn_;
    std::uint64_t hiddenTriangles_ = 0;
    bool rest_ = false;  // the guess is drawn, and something else, too
    // Scratch.
    std::vector<ScreenBox> boxes_;
    std::vector<std::uint8_t> hidden_;
    std::vector<std::uint32_t> pixels_, firstNumbers_;
};

}  // namespace iwalk
