#pragma once

#include "preprocess/build/build.hpp"
#include "preprocess/build/inputs.hpp"

namespace iwalk {

// What tests replace to reach the corners of buildDataset().
struct BuildParts {
    ImporterFactory openImporter = iwalk::openImporter;
    std::size_t batchTriangles = 0;  // at once in memory; 0: as many as memory allows
    std::size_t chunkBytes = 0;      // of the spill file; 0: as memory allows
};

Result<Manifest> buildDatasetFrom(const BuildOptions& options, Progress& progress, const BuildParts& parts);

}  // namespace iwalk
