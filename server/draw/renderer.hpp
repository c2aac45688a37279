#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <span>
#include <vector>

#include "common/dataset/hierarchy.hpp"
#include "common/settings.hpp"
#include "server/cache/page_cache.hpp"
#include "server/draw/blocks.hpp"
#include "server/draw/lines.hpp"
#include "server/draw/tile_pixels.hpp"
#include "server/draw/tints.hpp"
#include "server/visibility/depth_pyramid.hpp"
#include "server/visibility/frustum_visibility.hpp"

namespace iwalk {

// What a renderer needs to know of a dataset and how it is to look.
struct SceneLook {
    int stepExponent = 0;                  // one lattice step is 2^stepExponent model units
    LatticeBox bounds;                     // of the content, for the ramp
    bool colors = false, normals = false;  // what its pages have
    Shading shading = Shading::automatic;
    Ramp ramp = Ramp::automatic;
    std::uint32_t background = 0;  // 0xRRGGBB, sRGB
    Tints tints;                   // instead of colours
    bool overdraw = false;         // instead of colours: how many triangles cover a pixel
};

// One tile's view in one frame.
struct TileView {
    ScreenProjection projection;            // of the tile's screen
    int screenWidth = 0, screenHeight = 0;  // px
    PixelRect tile;                         // px of the screen
    LatticeEye eye;
    double near = 0;            // steps
    bool captureDepth = false;  // the frame is to have it, too
};

// Draws ranges of resident pages into a visibility buffer with reversed-Z 32-bit float depth and an infinite
// far plane; the tile's pixels get their colours when finish() is called. One serves all tiles of a rank, one
// after another. Needs a current GL context, on whose thread everything but the arena's memory stays.
class Renderer {
  public:
    // `tiles`: px of their screens; every view's must be among them.
    static Result<std::unique_ptr<Renderer>> create(std::span<const PixelRect> tiles, const SceneLook& look);
    virtual ~Renderer() = default;

    // Between frames: another look of the same dataset.
    virtual Result<void> setLook(const SceneLook& look) = 0;

    // Memory for `bytes` of pages (rounded up to kArenaAlignment), mapped until the renderer goes. What fetch
    // threads write there the GPU reads in place.
    static constexpr std::uint64_t kArenaAlignment = 256;
    virtual Result<std::vector<std::span<std::byte>>> lendArena(std::uint64_t bytes) = 0;

    // `pixels`, of the tile's size, are kept by reference until the next frame.
    virtual void beginFrame(const TileView& view, TilePixels& pixels) = 0;
    // What draw() is given from here to finish() shows in this block of the tile only. All blocks make a
    // frame.
    virtual void beginBlock(const Block& block) = 0;
    // `rank`: of the page in the block's order, from near to far: what is equally near is seen where it comes
    // first, if pages come in this order, up to beginRest() and again from there on; else what is drawn first
    // is seen. The result is the draw's number in the block.
    virtual std::uint32_t draw(const ResidentPage& page, const PageRecord& record, std::uint32_t rank,
                               std::span<const DrawnRange> ranges) = 0;
    // What is drawn from here on may come before what has been drawn. Once in a block at the most.
    virtual void beginRest() = 0;
    // Shades what was drawn since the last time; returns when the pixels are there and no page is read any
    // more.
    virtual void finish() = 0;

    // Over the block's pixels, when they are finished.
    virtual void drawLines(std::span<const Line> lines) = 0;

    // Returns when all that was drawn is there; pages are still needed.
    virtual void wait() = 0;
    // The pixels of the block's part as drawn so far: window depths, and, row by row, triangles as (number of
    // the draw + 1) << 16 | triangle in the page, or 0.
    virtual void readBlockDepths(DepthPyramid& depths) = 0;
    virtual void readBlockTriangles(std::vector<std::uint32_t>& numbers) = 0;
    // Makes the block's part GL's viewport, for others to test boxes against its depth. The result is the
    // part's width and height.
    virtual glm::ivec2 bindBlock() = 0;

    // Appends the window depths of the block's pixels, of a row here and there.
    virtual void sampleBlockDepths(std::vector<float>& depths) = 0;
};

}  // namespace iwalk
