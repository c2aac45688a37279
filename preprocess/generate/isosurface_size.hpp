#pragma once

#include <cstdint>

#include "preprocess/generate/isosurface_grid.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

// The grid on which the isosurface of `seed` has nearly `triangles` triangles (within 1 %).
IsosurfaceGrid findIsosurfaceGrid(std::uint64_t triangles, std::uint64_t seed, Progress& progress);

}  // namespace iwalk
