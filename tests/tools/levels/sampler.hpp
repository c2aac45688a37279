#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "tests/tools/levels/surface.hpp"

namespace iwalk::levels {

// `count` points spread evenly over the triangles' area: one in each of `count` parts of equal area, at
// random in it. Triangles that are lines get none while there is any area.
std::vector<glm::dvec3> sampleArea(const std::vector<FixedTriangle>& triangles, std::size_t count,
                                   std::uint64_t seed);

// The same over the length of those triangles that are lines: two corners equal. None when there are no
// lines.
std::vector<glm::dvec3> sampleLines(const std::vector<FixedTriangle>& triangles, std::size_t count,
                                    std::uint64_t seed);

// From each point to the surface; in the corners' units.
std::vector<double> distances(const std::vector<glm::dvec3>& points, const Surface& surface);

// What a sample of distances says.
struct Spread {
    double median = 0, p99 = 0, p999 = 0, max = 0;
};
// Of each percentile the smallest value that at least that share of `values` does not exceed; 0 for none.
Spread spreadOf(std::vector<double> values);

}  // namespace iwalk::levels
