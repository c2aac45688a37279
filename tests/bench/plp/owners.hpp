#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/dataset/page_files.hpp"
#include "server/frame/tile_pipeline.hpp"

namespace iwalk::bench {

// A range of the dataset and how many pixels of a tile it owns: it has their nearest surface.
struct Owned {
    std::uint32_t page = 0, range = 0;
    std::uint32_t pixels = 0;
};

// The pages of a cut, decoded, all in memory at once.
struct CutPages {
    std::vector<PageTable> tables;                // by page; empty for pages that are not of the cut
    std::vector<std::vector<std::byte>> decoded;  // likewise
};
Result<CutPages> loadPages(const Dataset& dataset, const Cut& cut);

// Draws triangle numbers instead of colours: says who owns each pixel of a wall when nothing is left out.
// Needs a current GL context. It takes the renderer's own vertex program, so pixels are the renderer's but
// for its blocks' rounding of depth.
class OwnerRenders {
  public:
    // The wall is one screen, at most 16384 px wide. All are kept by reference.
    static Result<std::unique_ptr<OwnerRenders>> create(const Dataset& dataset, const Cut& cut,
                                                        const CutPages& pages, int width, int height);
    ~OwnerRenders();

    // Owners of the pixels of each tile, by page and range.
    std::vector<std::vector<Owned>> draw(const Wall& wall, const Camera& camera);
    // Window depths of the tile's pixels when these ranges are drawn and nothing else.
    void depthsOf(const TileSight& sight, const std::vector<VisibleRanges>& chosen, DepthPyramid& depths);

  private:
    OwnerRenders(const Dataset& dataset, const Cut& cut, const CutPages& pages, int width, int height);
    void begin(const ScreenProjection& projection, double near);
    void drawPage(const PageRecord& record, std::uint32_t page, const LatticeEye& eye,
                  const std::vector<Range>& ranges);
    std::vector<Owned> countTile(const PixelRect& tile, const std::vector<std::uint32_t>& ids) const;

    const Dataset& dataset_;
    const Cut& cut_;
    const CutPages& pages_;
    const int width_, height_;                  // px
    std::vector<std::uint32_t> firstTriangle_;  // by page: the number of its first triangle, from 1
    std::array<std::uint32_t, 2> programs_{}, arrays_{};
    std::uint32_t framebuffer_ = 0, ids_ = 0, depth_ = 0, used_ = 0;
    std::vector<std::uint32_t> buffers_;  // by page; 0: none yet
};

}  // namespace iwalk::bench
