#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

// A rectangle of pixels; x to the right, y down, from the top left corner of what it lies in.
struct PixelRect {
    int x = 0, y = 0, width = 0, height = 0;  // px
    bool operator==(const PixelRect&) const = default;
};

// A flat surface of pixels as the eye sees it. Wall space: the eye at the origin, x to the right, y up, the
// viewer looking along -z; only directions and ratios count, so lengths have no unit.
struct Screen {
    glm::dvec3 topLeft{0}, topRight{0}, bottomLeft{0};  // its corners in wall space
    int width = 0, height = 0;                          // px
};

// How a projector's picture fades out where its neighbours show the same pixels.
struct Blend {
    int left = 0, right = 0, top = 0, bottom = 0;  // px shared with the neighbour on that side
    double gamma = 2.2;                            // light is the pixel's value to this power
    bool any() const { return left > 0 || right > 0 || top > 0 || bottom > 0; }
};

// A part of the wall, and where it is shown. Empty texts: the wall file does not say.
struct Tile {
    std::string name;  // letters, digits, '.', '_' and '-'; unique
    std::size_t screen = 0;
    PixelRect onScreen;  // px of its screen
    PixelRect onWall;    // px of the wall; free screens lie side by side there, in the file's order
    Blend blend{};
    std::string host{};                  // where its server is to run
    std::string display{};               // X display of its window, as in DISPLAY
    std::string monitor{};               // that its window fills, by the name that xrandr gives it
    std::optional<glm::ivec2> window{};  // place of its window on the display, px
};

// A wall file, understood. A regular wall is one screen, bezels included, cut into tiles; free screens have
// places of their own, and each may be cut into tiles, too.
struct Wall {
    int width = 0, height = 0;  // px, bezels included; of free screens side by side
    std::vector<Tile> tiles;    // row by row from the top, screen by screen
    std::vector<std::pair<std::string, std::string>>
        settings;                     // of its [settings] table: name, value as text
    double pixelAspect = 1;           // of a regular wall: a pixel's width / height
    std::vector<Screen> freeScreens;  // none: the wall is regular

    // The wall's screens for a camera. In a regular wall its vertical field of view (degrees) spans the whole
    // wall; free screens are where they are.
    std::vector<Screen> screens(double fovY) const;

    // Where a tile's window stands on its display, px: where the file says, or as on the wall, from the top
    // left corner of all tiles that share host and display.
    glm::ivec2 windowPlace(std::size_t tile) const;
};

// Reads a TOML wall file (config/). Errors name the file, the line and the column.
Result<Wall> loadWall(const std::string& path);

}  // namespace iwalk
