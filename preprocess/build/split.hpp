#pragma once

#include <vector>

#include "preprocess/import/importer.hpp"

namespace iwalk {

// What becomes of a triangle that is longer than kMostTriangleSteps. Positions are in lattice steps.
struct SplitTriangle {
    std::vector<Triangle> pieces;  // not longer than that; none when nothing is left
    bool isCut = false;            // a part of it is left out
};

// The longest that a triangle is kept whole, and how far from the middle of the model the parts lie that are
// kept of longer ones: lattice steps, in each axis. Raised: more of what lies far out, in more pieces.
inline constexpr double kLongestWhole = 2147483648.0, kReach = 1073741824.0;

// Splits along planes at fixed distances from `middle`, so that triangles which share an edge, and are split,
// get the same corners on it. Colours and normals are interpolated.
SplitTriangle splitTriangle(const Triangle& triangle, const glm::dvec3& middle);

}  // namespace iwalk
