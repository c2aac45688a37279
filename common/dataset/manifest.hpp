#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry.hpp"
#include "common/result.hpp"

namespace iwalk {

// The version of everything in a dataset directory.
inline constexpr std::uint32_t kDatasetVersion = 1;

// A file that the manifest names: a plain file name inside the dataset directory, and its size.
struct DatasetFile {
    std::string name;
    std::uint64_t bytes = 0;
};

// One input of a build and what became of it.
struct Provenance {
    std::string input;            // file name as given, without its directory
    std::uint64_t triangles = 0;  // stored in the dataset
    // Left out: with a corner that is not a finite number; with fewer than three distinct lattice positions.
    std::uint64_t droppedNonFinite = 0, droppedDegenerate = 0;
    // In several pieces, being too long for a page; and of them those that are not all there
    // (docs/format.md).
    std::uint64_t split = 0, cut = 0;
};

// The whole model at one level.
struct LevelSummary {
    double error = 0;             // e_level in model units; 0 of full
    std::uint64_t triangles = 0;  // drawn when all of the model is drawn at this level
    std::uint64_t bytes = 0;      // on disk: pages and morph blocks of this level's entries
    bool operator==(const LevelSummary&) const = default;
};

// `dataset.json`: small, human, and the one commit of a dataset (docs/format.md).
struct Manifest {
    std::uint32_t generation = 1;  // G in the files' names; grows with each commit
    ModelBox bounds;               // of the input; model units
    int stepExponent = 0;          // one lattice step is 2^stepExponent model units
    std::uint64_t triangles = 0;   // of the input, each once
    std::uint64_t vertices = 0;    // in the pages of all levels
    std::uint64_t nodes = 0, leaves = 0, pages = 0;
    std::uint64_t leafTriangles = 0;   // nodes with more triangles than this are split
    std::vector<LevelSummary> levels;  // from level 0 on; none in a dataset without levels
    LevelSummary full;
    bool colors = false, normals = false;  // attributes present in pages
    DatasetFile hierarchy;
    std::vector<DatasetFile> pageFiles;
    std::vector<Provenance> provenance;
};

inline constexpr const char* kManifestName = "dataset.json";

// Reads and checks DATASET/dataset.json: version, types, ranges, that the files named are plain names, exist
// and have the sizes said. Errors name the file and the key.
Result<Manifest> loadManifest(const std::string& dataset);

// The commit: replaces DATASET/dataset.json. All that it names must have been fsynced.
Result<void> saveManifest(const std::string& dataset, const Manifest& manifest);

}  // namespace iwalk
