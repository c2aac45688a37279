#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "server/draw/gl_context.hpp"
#include "server/present/swap_group.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// A tile's window on an X display. Without a frame and of the tile's size; it fills the tile's monitor, or
// stands at a place of its display. Black until the first picture.
class WallWindow {
  public:
    virtual ~WallWindow() = default;

    // Shows an RGBA8 texture of the window's size, row 0 on top, and keeps showing it: it must stay. Returns
    // when the buffers are swapped.
    virtual void show(std::uint32_t texture) = 0;
    // Takes what the display has to say, and shows the last picture again where it was lost. True when
    // somebody pressed Escape or the window's close button.
    virtual bool closed() = 0;
    // NV_swap_group, where the driver has it; from then on a picture that was lost waits for the next frame.
    virtual SwapGroupDriver& swapGroupDriver() = 0;
};

// The windows of a rank, all on one X display, and the GL context that draws for them: the first window's.
// The others' contexts only show its textures. Of a frame's swaps the first window's waits for the screen's
// refresh and must come first; the others follow at once, so that it is waited only once. Stays on the thread
// that opened it; one in a process.
class WallWindows : public GlContext {
  public:
    struct Place {
        Tile tile;
        glm::ivec2 at;  // px of the display, where the tile has no monitor
    };
    // Errors say which displays or monitors there are.
    static Result<std::unique_ptr<WallWindows>> open(const std::vector<Place>& places);

    // In the order of the places.
    virtual WallWindow& window(std::size_t i) = 0;
};

// An X display by its whole name, "[HOST]:NUMBER.SCREEN"; screen 0 goes without saying.
std::string wholeDisplayName(const std::string& name);

}  // namespace iwalk
