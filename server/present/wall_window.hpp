#pragma once

#include <glm/vec2.hpp>
#include <memory>

#include "common/result.hpp"
#include "server/draw/gl_context.hpp"
#include "server/present/swap_group.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// A tile's window on an X display, and the GL context that draws for it. Without a frame and of the tile's
// size; it fills the tile's monitor, or stands at a place of its display. Black until the first picture.
// Stays on the thread that opened it; one in a process.
class WallWindow : public GlContext {
  public:
    // `place`: px of the display, where the tile has no monitor. Errors say which displays or monitors there
    // are.
    static Result<std::unique_ptr<WallWindow>> open(const Tile& tile, const glm::ivec2& place);

    // Shows the pixels of GL's `framebuffer`, of the window's size and row 0 on top, and keeps showing them:
    // it must stay. Returns when the buffers are swapped.
    virtual void show(std::uint32_t framebuffer) = 0;
    // Takes what the display has to say, and shows the last picture again where it was lost. True when
    // somebody pressed Escape or the window's close button.
    virtual bool closed() = 0;
    // NV_swap_group, where the driver has it; from then on a picture that was lost waits for the next frame.
    virtual SwapGroupDriver& swapGroupDriver() = 0;
};

}  // namespace iwalk
