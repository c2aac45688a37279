#pragma once

#include <cstdint>
#include <vector>

#include "tests/tools/levels/dataset_pages.hpp"
#include "tests/tools/levels/deviation.hpp"

namespace iwalk::levels {

// Multiples of the stated error: 1 is as far from the input as promised.
struct LevelErrors {
    unsigned level = 0;
    std::uint64_t triangles = 0;
    double error = 0;     // stated, model units
    Deviation whole;      // the whole model at this level
    Deviation halfMorph;  // half way from the next finer level to this one
};

// Of each level from coarse to fine, found by sampling.
Result<std::vector<LevelErrors>> measureErrors(const DatasetPages& pages, const SampleOptions& options);

}  // namespace iwalk::levels
