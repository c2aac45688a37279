#pragma once

#include <cstdint>

#include "preprocess/generate/ply_output.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

// An industrial plant, to be walked through: storeys of bays of 8 x 8 x 5 m with floors, girders, walls with
// doors, cable trays, tanks, and as many pipes with elbows, flanges and valves as triangles are wanted. Every
// part is a closed surface in the colour of its kind. Units are metres; z is up.
Result<void> generatePlant(std::uint64_t triangles, std::uint64_t seed, PlyOutput& output,
                           Progress& progress);

}  // namespace iwalk
