#pragma once

#include <cstdint>

#include "preprocess/generate/ply_output.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

// A turbulent mixing layer, in the manner of the Richtmyer-Meshkov simulations of Lawrence Livermore National
// Laboratory (Mirin et al., Very High Resolution Simulation of Compressible Turbulence on the IBM-SP System,
// Supercomputing 1999): the surface between two fluids, on a square of 100 x 100 model units, coloured by
// height. Closed but for its border on the square's four sides.
Result<void> generateIsosurface(std::uint64_t triangles, std::uint64_t seed, PlyOutput& output,
                                const std::string& spillDirectory, Progress& progress);

}  // namespace iwalk
