#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "server/visibility/workers.hpp"
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
// meet it, so that neighbouring rays are one vector instruction. Rows of the grid make bands, which threads
// take: what a ray keeps depends on its own way alone. And rays do not end below 0.01. That spares
// little, and where an estimate is too dark (the eye in a dense cell) all that is left would be equal.
class RayGrid {
  public:
    // `near`: steps; `raysPerPixel`: (0, 1], but there is at least one ray.
    RayGrid(const ScreenProjection& projection, const PixelRect& tile, double near, double raysPerPixel);

    // A ray that passes the box keeps exp(-density * its steps in the box) of its contribution, and never
    // loses all.
    struct Pass {
        EyeBox box;
        float density = 0;
    };
    // What the rays that meet a box bring to it: its part of the picture, in rays, as far as it is not
    // covered. A box between the rays has the part of a ray that its rectangle is of the grid's cells.
    struct Arrival {
        float rays = 0;          // how many meet the box
        float contribution = 0;  // of all of them together
        bool operator==(const Arrival&) const = default;
    };
    // Sends the rays through one box after another. The result, by box, is the same for any number of
    // threads.
    std::vector<Arrival> cross(std::span<const Pass> boxes, Workers& workers);

  private:
    struct Cells {
        int left = 0, right = 0, top = 0, bottom = 0;  // columns [left, right), rows [top, bottom)
        float area = 0;                                // of the rectangle, in cells
    };
    struct Met {
        Arrival arrival;
        float around = 0;  // where no ray meets the box: contribution of all rays of its cells
        void add(const Met& other) {
            arrival.rays += other.arrival.rays;
            arrival.contribution += other.arrival.contribution;
            around += other.around;
        }
    };
    Cells cellsOf(const EyeBox& box) const;
    Met crossRows(const Pass& pass, const Cells& cells, int top, int bottom);
    std::size_t firstOf(int row) const { return static_cast<std::size_t>(row) * stride_; }

    int columns_, rows_;
    std::size_t stride_;  // of rows; a packet that begins in a row ends in it
    float near_;
    glm::mat3 toGrid_;                 // like ScreenProjection::toPixels, to cells of the grid
    std::vector<float> inverse_[3];    // by ray: 1 / its direction, as long as D (projection.hpp) is 1
    std::vector<float> length_;        // by ray: of that direction
    std::vector<float> contribution_;  // by ray
};

}  // namespace iwalk
