#pragma once

#include <cstdint>

#include "tests/tools/levels/cracks.hpp"

namespace iwalk::levels {

struct ViewOptions {
    std::size_t views = 100;
    std::uint64_t seed = 1;
    int size = 192;                                   // px, width and height of a picture
    double minScreenError = 0.5, maxScreenError = 8;  // px; log-uniform in between
};

struct ViewReport {
    std::uint64_t covered =
        0;  // pixels of all pictures that show the input as far as the screen error around them
    std::uint64_t holes = 0;      // those of them where the cut shows the background
    std::uint64_t triangles = 0;  // drawn, of all cuts
};

// Casts rays at the cuts of random eyes and screen errors, and at the input. `errors` as for
// levelDistances().
ViewReport countHoles(const RangeModel& model, const std::vector<double>& errors, const ViewOptions& options);

}  // namespace iwalk::levels
