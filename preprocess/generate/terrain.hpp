#pragma once

#include "preprocess/generate/ply_output.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

// A piece of land, 16 km long and wide: mountains, hills and sea, coloured by height; z is up, in metres, and
// 0 at the sea's surface.
Result<void> generateTerrain(std::uint64_t triangles, std::uint64_t seed, PlyOutput& output,
                             Progress& progress);

}  // namespace iwalk
