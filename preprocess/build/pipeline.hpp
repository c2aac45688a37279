#pragma once

#include <optional>

#include "preprocess/build/build.hpp"
#include "preprocess/build/inputs.hpp"
#include "preprocess/build/lattice.hpp"
#include "preprocess/levels/levels.hpp"

namespace iwalk {

// What tests replace to reach the corners of buildDataset() and insertIntoDataset().
struct BuildParts {
    ImporterFactory openImporter = iwalk::openImporter;
    std::size_t batchTriangles = 0;  // at once in memory; 0: as many as memory allows
    std::size_t chunkBytes = 0;      // of the spill file; 0: as memory allows
    LevelSizes levels{};
    std::optional<Lattice> lattice;  // of a build, with its root's cell; what holds all inputs, if absent
};

Result<Manifest> buildDatasetFrom(const BuildOptions& options, Progress& progress, const BuildParts& parts);
Result<Manifest> insertIntoDatasetFrom(const BuildOptions& options, Progress& progress,
                                       const BuildParts& parts);

}  // namespace iwalk
