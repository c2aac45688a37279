#pragma once

#include <string>
#include <vector>

#include "preprocess/build/build.hpp"

namespace iwalk {

struct Verification {
    std::uint64_t pages = 0, triangles = 0, bytes = 0;  // that were read
    std::vector<std::string> problems;                  // one line each, naming file, page and offset
};

// Reads all of a dataset and checks what loading does not: every page decodes, every box is exactly that of
// its triangles, and every triangle is in a node where it belongs. Fails when manifest or hierarchy cannot be
// loaded.
Result<Verification> verifyDataset(const std::string& dataset, Progress& progress);

}  // namespace iwalk
