#include "server/wall/wall.hpp"

#include <cmath>
#include <glm/common.hpp>
#include <numbers>

namespace iwalk {

std::vector<Screen> Wall::screens(double fovY) const {
    if (!freeScreens.empty()) return freeScreens;
    const double y = std::tan(fovY * std::numbers::pi / 360);
    const double x = y * pixelAspect * width / height;
    Screen screen;
    screen.topLeft = {-x, y, -1};
    screen.topRight = {x, y, -1};
    screen.bottomLeft = {-x, -y, -1};
    screen.width = width;
    screen.height = height;
    return {screen};
}

glm::ivec2 Wall::windowPlace(std::size_t tile) const {
    const Tile& one = tiles[tile];
    if (one.window) return *one.window;
    glm::ivec2 corner(one.onWall.x, one.onWall.y);
    for (const Tile& other : tiles)
        if (other.host == one.host && other.display == one.display)
            corner = glm::min(corner, glm::ivec2(other.onWall.x, other.onWall.y));
    return glm::ivec2(one.onWall.x, one.onWall.y) - corner;
}

}  // namespace iwalk
