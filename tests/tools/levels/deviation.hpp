#pragma once

#include <cstdint>
#include <vector>

#include "tests/tools/levels/sampler.hpp"

namespace iwalk::levels {

struct SampleOptions {
    std::size_t samples = 100'000;  // on each surface; more find rarer faults, and take longer
    std::uint64_t seed = 1;
};

// What surfaces are compared with: the input, prepared once.
class Reference {
  public:
    // At least one triangle.
    Reference(std::vector<FixedTriangle> triangles, const SampleOptions& options);
    const std::vector<glm::dvec3>& points() const { return points_; }
    const Surface& surface() const { return surface_; }
    const SampleOptions& options() const { return options_; }

  private:
    SampleOptions options_;
    std::vector<glm::dvec3> points_;
    Surface surface_;
};

// Distances between a surface and the input, as multiples of some error.
struct Deviation {
    Spread fromFull;     // from points on the input to the surface; infinite where that has no triangles
    Spread toFull;       // from points on the surface to the input
    Spread linesToFull;  // from points on triangles that are lines to the input; a tenth of the samples

    double largest() const;
    double p999() const;  // of the worse direction, without lines
};

// `error` in the corners' units.
Deviation deviationOf(std::vector<FixedTriangle> triangles, const Reference& full, double error);

}  // namespace iwalk::levels
