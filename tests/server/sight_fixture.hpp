#pragma once

#include "server/visibility/entry_priority.hpp"

namespace iwalk {

// A tile of width x height px that looks from `eye` (lattice) along `forward`, with a field of view of `fovY`
// degrees; the near plane is `near` steps away.
inline TileSight sightFrom(const glm::dvec3& eye, const glm::dvec3& forward, int width = 400,
                           int height = 300, double fovY = 60, double near = 0.5) {
    Wall wall;
    wall.width = width, wall.height = height;
    const glm::dvec3 up = forward.x == 0 && forward.y == 0 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const Camera camera{eye, eye + forward, up, fovY};
    return {
        projectScreen(wall.screens(fovY)[0], camera), {0, 0, width, height}, LatticeEye::at(eye, 0), near};
}

}  // namespace iwalk
