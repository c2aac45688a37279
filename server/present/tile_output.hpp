#pragma once

#include <cstdint>
#include <memory>

#include "common/image.hpp"
#include "common/result.hpp"
#include "server/present/blend_pass.hpp"
#include "server/present/wall_window.hpp"

namespace iwalk {

// The way of a tile's finished pixels to people's eyes: blended where projectors overlap, into a window if
// there is one. Needs the current GL context that draws.
class TileOutput {
  public:
    // `window`: kept by reference; null: nothing is shown, only read.
    static Result<std::unique_ptr<TileOutput>> create(const Tile& tile, WallWindow* window);
    ~TileOutput();
    TileOutput(const TileOutput&) = delete;
    TileOutput& operator=(const TileOutput&) = delete;

    // Makes a finished picture ready to be shown: an RGBA8 texture of the tile's size, row 0 on top.
    void prepare(std::uint32_t drawn);
    // Shows what was prepared last. Returns when the window has swapped; at once without a window.
    void show();
    // What show() shows.
    ColorImage read() const;
    SwapGroupDriver* swapGroupDriver() { return window_ ? &window_->swapGroupDriver() : nullptr; }
    // Looks after the window between frames: uncovered parts are shown again. True when somebody closed it.
    bool closed();

  private:
    TileOutput(const Tile& tile, WallWindow* window);

    const int width_, height_;  // px
    WallWindow* const window_;
    std::unique_ptr<BlendPass> blend_;           // null: no overlap
    std::uint32_t framebuffer_ = 0, shown_ = 0;  // GL's: to read what is shown, and the texture that is
};

}  // namespace iwalk
