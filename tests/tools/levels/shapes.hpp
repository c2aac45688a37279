#pragma once

#include <cmath>
#include <vector>

#include "tests/tools/levels/triangle.hpp"
#include "tests/tools/scenes.hpp"

// Known shapes on the grid of fixed corners, for tests.
namespace iwalk::levels {

// One model unit is this many parts.
inline constexpr double kParts = 1 << 28;

inline std::vector<FixedTriangle> toFixed(const tools::Triangles& triangles) {
    std::vector<FixedTriangle> fixed;
    for (const tools::Triangle& triangle : triangles) {
        FixedTriangle t;
        for (std::size_t c = 0; c < 3; ++c) {
            for (int axis = 0; axis < 3; ++axis)
                t[c][axis] = static_cast<std::int32_t>(std::lround(kParts * triangle[c][axis]));
        }
        fixed.push_back(t);
    }
    return fixed;
}

// A square of side 1 at height z, in 2 n^2 triangles.
inline std::vector<FixedTriangle> plane(int n, double z) {
    tools::Triangles triangles;
    const auto at = [&](int i, int k) {
        return glm::dvec3(static_cast<double>(i) / n, static_cast<double>(k) / n, z);
    };
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    }
    return toFixed(triangles);
}

}  // namespace iwalk::levels
