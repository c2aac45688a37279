#pragma once

#include <cstdint>
#include <string>

#include "common/result.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

inline constexpr std::uint64_t kLeastGenerated = 1'000, kMostGenerated = 1'000'000'000;  // triangles

struct GenerateOptions {
    std::string scene;                    // sphere, plant, isosurface, terrain, or one of hard.hpp
    std::uint64_t triangles = 1'000'000;  // wanted: kLeastGenerated to kMostGenerated
    std::uint64_t seed = 1;
    std::string output;  // a PLY file; replaced when it is there
};

struct Generated {
    std::uint64_t vertices = 0, triangles = 0, bytes = 0;
};

// Makes a model of nearly as many triangles as wanted (within 1 %) for tests and measurements, streamed:
// memory stays at some tens of megabytes. The file's bytes depend on scene, triangles and seed alone, not on
// the machine: only operations that IEEE 754 rounds correctly (+ - * / sqrt) and integers make them. `output`
// has its old contents or all of the new ones, never a part.
Result<Generated> generateScene(const GenerateOptions& options, Progress& progress);

}  // namespace iwalk
