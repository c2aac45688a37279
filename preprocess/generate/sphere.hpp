#pragma once

#include <cstdint>

#include "preprocess/generate/ply_output.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

// A closed sphere of radius 10 model units around the origin with a rough surface, like a small planet. No
// colours.
Result<void> generateSphere(std::uint64_t triangles, std::uint64_t seed, PlyOutput& output,
                            Progress& progress);

}  // namespace iwalk
