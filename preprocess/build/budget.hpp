#pragma once

#include <cstdint>

#include "common/result.hpp"
#include "preprocess/build/build.hpp"

namespace iwalk {

inline constexpr std::uint64_t kMinMemoryBytes = std::uint64_t{64} << 20;

// Who gets how much of BuildOptions::memoryBytes. Reading and building follow one another, so each may have
// nearly all.
struct Budget {
    std::uint64_t importerBytes = 0;  // all importers together
    std::size_t chunkBytes = 0;       // of the spill file, one buffer for each bin
    std::uint64_t batchBytes = 0;     // triangles in memory at once, and what sorting them takes
    unsigned threads = 1;             // that read, and build pages
};

// Fails when the limit is too low.
Result<Budget> makeBudget(const BuildOptions& options);

}  // namespace iwalk
