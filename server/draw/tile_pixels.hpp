#pragma once

#include <cstdint>
#include <memory>

#include "common/image.hpp"
#include "common/result.hpp"
#include "server/draw/thumbnail.hpp"

namespace iwalk {

// One tile's finished pixels, row 0 on top: RGBA8 colour, and eye-space depth in frames whose depth is
// wanted. Needs a current GL context.
class TilePixels {
  public:
    static Result<std::unique_ptr<TilePixels>> create(int width, int height);
    ~TilePixels();
    TilePixels(const TilePixels&) = delete;
    TilePixels& operator=(const TilePixels&) = delete;

    int width() const { return width_; }
    int height() const { return height_; }

    // A new frame: the background (0xRRGGBB, sRGB) everywhere.
    void clear(std::uint32_t background, bool depth);
    // GL's: for the frame's colour, and depth (colour attachment 1) if it has one; and for colour alone.
    std::uint32_t framebuffer() const { return depth_ ? depthFramebuffer_ : colorFramebuffer_; }
    std::uint32_t colorFramebuffer() const { return colorFramebuffer_; }
    std::uint32_t colorTexture() const { return color_; }

    ColorImage readColor() const;
    // The frame's colours at this size, or its own where that is less.
    ColorImage readSmall(int width, int height) {
        return thumbnail_.read(colorFramebuffer_, width_, height_, width, height);
    }
    // Eye-space depth in model units, 0 where there is no surface; of a frame with depth.
    DepthImage readDepth() const;

  private:
    TilePixels(int width, int height) : width_(width), height_(height) {}
    void addDepth();

    const int width_, height_;  // px
    Thumbnail thumbnail_;
    std::uint32_t color_ = 0, colorFramebuffer_ = 0;     // GL names
    std::uint32_t eyeDepth_ = 0, depthFramebuffer_ = 0;  // made when depth is first wanted
    bool depth_ = false;                                 // this frame has one
};

}  // namespace iwalk
