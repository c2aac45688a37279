#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/generate/isosurface_grid.hpp"
#include "preprocess/generate/spline_octave.hpp"

namespace iwalk {

// Two fluids that mix: negative in the lower one, positive in the upper one, 0 on the surface between them. A
// height, pushed about by turbulence: octaves of noise down to some cells of the grid, weakening slowly, as
// in Kolmogorov's cascade, so that overhangs, plumes and drops come in all sizes. Turbulence fades towards
// the layer's bottom and top, where the field has one sign.
class MixingField {
  public:
    MixingField(std::uint64_t seed, const IsosurfaceGrid& grid);

    // The field at the points (x, *, *), model units: [rows()][stride()]; the padding repeats the last point.
    void slab(std::uint32_t x, std::span<float> values);

  private:
    struct Octave {
        SplineOctave noise;
        float strength = 0;   // model units
        bool billow = false;  // |noise|: round heads with clefts between them
        // What all finer octaves together change, but for one place in ten thousand; model units.
        float rest = 0;
    };
    void row(std::uint32_t z, float* values);

    IsosurfaceGrid grid_;
    std::vector<Octave> octaves_;  // coarse to fine
    std::vector<std::size_t>
        near_;  // runs of the row that finer octaves can change the sign of: first points
};

}  // namespace iwalk
