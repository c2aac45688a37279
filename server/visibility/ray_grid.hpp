#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "server/wall/projection.hpp"

namespace iwalk {

// From the eye, steps.
struct EyeBox {
    glm::vec3 low{0}, high{0};
};

// Sparse rays through a tile (Correa 2004, section 4.3.1): one in each cell of a grid, at a place in the cell
// that never changes. Each starts with contribution 1 and loses some of it to every box that it passes.
//
// Departures: the loops are exchanged, as boxes come front to back anyway: for each box the rays that may
// meet it, so that neighbouring rays are one vector instruction. And rays do not end below 0.01. That spares
// little, and where an estimate is too dark (the eye in a dense cell) all that is left would be equal.
class RayGrid {
  public:
    // `near`: steps; `raysPerPixel`: (0, 1], but there is at least one ray.
    RayGrid(const ScreenProjection& projection, const PixelRect& tile, double near, double raysPerPixel);

    // What the rays that meet a box bring to it: its part of the picture, in rays, as far as it is not
    // covered. A box between the rays has the part of a ray that its rectangle is of the grid's cells.
    struct Arrival {
        float rays = 0;          // how many meet the box
        float contribution = 0;  // of all of them together
    };
    Arrival arrivingAt(const EyeBox& box) const;

    // The same; then each ray keeps exp(-density * its steps in the box) of its contribution.
    Arrival pass(const EyeBox& box, float density);

  private:
    struct Cells {
        int left, right, top, bottom;  // columns [left, right), rows [top, bottom)
        float area;                    // of the rectangle, in cells
    };
    Cells cellsOf(const EyeBox& box) const;
    template <class Meet>
    Arrival forRays(const EyeBox& box, const Meet& meet) const;

    int columns_, rows_;
    float near_;
    glm::dmat3 toGrid_;                // like ScreenProjection::toPixels, to cells of the grid
    std::vector<float> inverse_[3];    // by ray: 1 / its direction, as long as D (projection.hpp) is 1
    std::vector<float> length_;        // by ray: of that direction
    std::vector<float> contribution_;  // by ray
};

}  // namespace iwalk
