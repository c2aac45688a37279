#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/dataset/manifest.hpp"
#include "common/result.hpp"
#include "preprocess/import/importer.hpp"
#include "preprocess/progress.hpp"

namespace iwalk {

struct BuildOptions {
    std::vector<std::string> inputs;
    std::string output;  // the dataset's directory; made when it is not there
    std::uint64_t memoryBytes = std::uint64_t{512} << 20;  // peak resident memory of the process
    // A node with more triangles is split. Default 16384: fewer reads and nodes when raised, coarser culling
    // of pages.
    std::uint32_t leafTriangles = 16384;
    std::optional<int>
        stepExponent;      // lattice step as a power of two in model units; chosen from the input if absent
    unsigned threads = 0;  // 0: as many as there are cores
    ImportChoices import{};
};

// Builds a dataset. Memory stays below the limit at any input size; all temporary files live in the output
// directory and are gone afterwards, whether it succeeds or fails; a dataset that was there stays intact
// until the new one is committed. Output bytes depend on the inputs, the leaf size and the step alone.
Result<Manifest> buildDataset(const BuildOptions& options, Progress& progress);

// Adds models to the dataset `options.output`, on its lattice and with its leaf size; the octree's root grows
// when they lie outside. Killed at any moment, the dataset is as before or complete. Nodes that no new
// triangle touches keep their pages; what the others had stays in the files as garbage, until the dataset is
// compacted. Colours and normals that the dataset does not have are dropped, which is noted.
Result<Manifest> insertIntoDataset(const BuildOptions& options, Progress& progress);

}  // namespace iwalk
