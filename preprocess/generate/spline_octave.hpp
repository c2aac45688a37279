#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/generate/four.hpp"
#include "preprocess/generate/isosurface_grid.hpp"

namespace iwalk {

// One octave of noise on the points of a grid: a uniform cubic B-spline over random numbers in [-1, 1] on a
// lattice. Smooth (C2), without the creases and plateaus that interpolated value noise has along the
// lattice's planes. As a product of three splines it is interpolated along x once for a slab, along y once
// for a lattice cell, and along z for each point: four products, four points at once.
class SplineOctave {
  public:
    // `cells`: of the lattice, along the layer's side.
    SplineOctave(std::uint32_t seed, double cells, const IsosurfaceGrid& grid);

    void slab(std::uint32_t x);  // the points (x, *, *) from now on; cheap when x advances by little
    // The noise along the row, until the next call of row() or slab().
    class Row {
      public:
        Four at(std::size_t first) const {  // points first to first + 3
            return weights_[0] * loadFour(lines_[0] + first) + weights_[1] * loadFour(lines_[1] + first) +
                   (weights_[2] * loadFour(lines_[2] + first) + weights_[3] * loadFour(lines_[3] + first));
        }

      private:
        friend SplineOctave;
        std::array<Four, 4> weights_;          // of four rows of the lattice
        std::array<const float*, 4> lines_{};  // their values
    };
    // At the points (x, *, z); cheap when z advances by little.
    Row row(std::uint32_t z);

  private:
    using Weights = std::array<float, 4>;
    struct Place {
        std::int32_t cell = 0;
        float fraction = 0;  // [0, 1)
    };
    static Place place(double coordinate);
    static Weights weightsOf(float fraction);
    void fillPlane(std::int32_t x, std::vector<float>& plane) const;
    void fillLine(std::size_t z, std::vector<float>& line) const;

    std::uint32_t seed_;
    double scale_, scaleZ_;  // lattice cells in a step of the grid: x and y; z
    std::size_t latticeY_ = 0, latticeZ_ = 0;
    std::vector<std::uint32_t> cellOf_;         // by y
    std::vector<Weights> weightsOfY_;           // by y
    std::array<std::vector<float>, 4> planes_;  // the lattice's planes around x; plane i is at i mod 4
    std::array<std::int32_t, 4> planeAt_{};
    std::vector<float> plane_;  // interpolated along x: [latticeZ_][latticeY_]
    std::array<std::vector<float>, 4>
        lines_;  // and along y, for the lattice's rows around z; row i is at i mod 4
    std::array<std::int32_t, 4> lineAt_{};
};

}  // namespace iwalk
