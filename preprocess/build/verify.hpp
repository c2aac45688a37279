#pragma once

#include <string>
#include <vector>

#include "preprocess/build/build.hpp"

namespace iwalk {

struct Verification {
    std::uint64_t pages = 0, triangles = 0, bytes = 0;  // that were read
    std::vector<std::string> problems;                  // one line each, naming file, page and offset
};

// Reads all of a dataset and checks what loading does not: every page and morph block decodes, boxes contain
// what they should, every triangle of the input is in the node and cell where it belongs, and each level
// follows from the next finer one (docs/format.md). Levels are looked at when all pages are good by
// themselves. Memory: the hierarchy, and about 250 MB at most. Fails when manifest or hierarchy cannot be
// loaded.
Result<Verification> verifyDataset(const std::string& dataset, Progress& progress);

}  // namespace iwalk
