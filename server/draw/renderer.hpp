#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/dataset/hierarchy.hpp"
#include "common/image.hpp"
#include "common/settings.hpp"
#include "server/cache/page_cache.hpp"
#include "server/visibility/frustum_visibility.hpp"

namespace iwalk {

// What a renderer needs to know of a dataset and stays the same from frame to frame.
struct SceneLook {
    int stepExponent = 0;          // one lattice step is 2^stepExponent model units
    LatticeBox bounds;             // of the content, for the ramp
    bool colors = false, normals = false;  // what its pages have
    Shading shading = Shading::automatic;
    Ramp ramp = Ramp::automatic;
    std::uint32_t background = 0;  // 0xRRGGBB, sRGB
};

// One tile's view in one frame.
struct TileView {
    ScreenProjection projection;  // of the tile's screen
    int screenWidth = 0, screenHeight = 0;  // px
    PixelRect tile;               // px of the screen
    LatticeEye eye;
    double near = 0;              // steps
    bool captureDepth = false;    // readDepth() will be asked for
};

// Draws ranges of resident pages into an own framebuffer: reversed-Z 32-bit float depth with an infinite far plane, a
// visibility buffer, and RGBA8 colour that each pixel gets once, when finish() is called. Needs a current GL context, on whose thread everything but the arena's memory stays.
class Renderer {
  public:
    static Result<std::unique_ptr<Renderer>> create(int width, int height, const SceneLook& look);
    virtual ~Renderer() = default;

    // Memory for `bytes` of pages (rounded up to kArenaAlignment), mapped until the renderer goes. What fetch threads
    // write there the GPU reads in place.
    static constexpr std::uint64_t kArenaAlignment = 256;
    virtual Result<std::vector<std::span<std::byte>>> lendArena(std::uint64_t bytes) = 0;

    virtual void beginFrame(const TileView& view) = 0;
    virtual void draw(const ResidentPage& page, const PageRecord& record, std::span<const IndexRun> runs) = 0;
    // Shades what was drawn since the last time; returns when the pixels are there and no page is read any more.
    virtual void finish() = 0;

    virtual ColorImage readColor() = 0;
    // Eye-space depth in model units, 0 where there is no surface; of a frame with captureDepth.
    virtual DepthImage readDepth() = 0;
};

}  // namespace iwalk
