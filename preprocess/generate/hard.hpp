#pragma once

#include <string_view>

#include "preprocess/generate/ply_output.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

// Scenes that break what is careless. All are small grids of cells with something that such models are not
// expected to have:
//   hard-far      1 mm large cells, 10,000,000 m from the origin on all axes
//   hard-slivers  triangles a million times as long as wide, without area, twice, or upon one another
//   hard-point    triangles that all share one vertex
//   hard-flat     triangles that all lie in one plane
//   hard-outlier  one vertex a million times as far away as all others
//   hard-huge     one triangle as large as all others together
bool isHardScene(std::string_view name);
// Positions of 64 bits where 32 would not do.
VertexLayout hardLayout(std::string_view name);
Result<void> generateHard(std::string_view name, std::uint64_t triangles, std::uint64_t seed,
                          PlyOutput& output, Progress& progress);

}  // namespace iwalk
