#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
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

// What one server draws.
struct Tile {
    std::string name;  // letters, digits, '.', '_' and '-'; unique
    std::size_t screen = 0;
    PixelRect onScreen;  // px of its screen
    PixelRect onWall;    // px of the wall
};

// A wall file, understood. A regular wall is one screen, bezels included, cut into tiles.
struct Wall {
    int width = 0, height = 0;  // px, bezels included
    int rows = 0, columns = 0;
    glm::ivec2 tilePx{0}, bezelPx{0};
    std::vector<Tile> tiles;  // row by row from the top; tile i is for rank i
    std::vector<std::pair<std::string, std::string>>
        settings;  // of its [settings] table: name, value as text

    // The wall's screens for a camera whose vertical field of view (degrees) spans the whole wall.
    std::vector<Screen> screens(double fovY) const;
};

// Reads a TOML wall file (config/). Errors name the file, the line and the column.
Result<Wall> loadWall(const std::string& path);

}  // namespace iwalk
