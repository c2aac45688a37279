#pragma once

#include <cstdint>
#include <vector>

#include "tests/tools/levels/dataset_pages.hpp"
#include "tests/tools/levels/deviation.hpp"

namespace iwalk::levels {

// A level beside what meshoptimizer's simplifier makes of the whole welded input at the same true error: the
// 99.9th percentile of sampled distances, in the worse direction. Theirs is interpolated between meshes whose
// error bounds are a factor of 2 apart, and all of the input where no bound makes it as good.
struct SimplifyRace {
    unsigned level = 0;
    std::uint64_t triangles = 0, theirTriangles = 0;
    double p999 = 0;     // multiples of the level's stated error
    bool stuck = false;  // theirs could go no lower, whatever error it was allowed; it has a smaller one

    double ratio() const { return static_cast<double>(triangles) / static_cast<double>(theirTriangles); }
};

Result<std::vector<SimplifyRace>> raceSimplify(const DatasetPages& pages, const SampleOptions& options);

}  // namespace iwalk::levels
