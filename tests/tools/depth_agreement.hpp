#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/image.hpp"

namespace iwalk::tools {

struct DepthDisagreement {
    int x = 0, y = 0;       // column from the left, row from the top
    double depth = 0;       // of the picture; model units, 0: no surface
    double reference = 0;   // of the ray caster
    double difference = 0;  // |depth - reference| / reference; infinite when only one of them has a surface
};

struct DepthAgreement {
    std::uint64_t pixels = 0, agreed = 0;
    std::uint64_t missing = 0;             // among those that disagree: only the reference has a surface
    std::uint64_t extra = 0;               // and: only the picture has one
    std::vector<DepthDisagreement> worst;  // the largest differences first

    double fraction() const { return static_cast<double>(agreed) / static_cast<double>(pixels); }  // [0, 1]
};

// A pixel agrees when neither picture has a surface there, or both have and |z - z_ref| <= relative * z_ref.
// Both of one size, not empty. Lists at most `worst` disagreements.
DepthAgreement depthAgreement(const DepthImage& picture, const Image<double>& reference, double relative,
                              std::size_t worst = 10);

}  // namespace iwalk::tools
