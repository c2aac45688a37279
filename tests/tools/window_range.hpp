#pragma once

#include <limits>

#include "common/image.hpp"

namespace iwalk::tools {

// Where there is no surface (0) one sees infinitely far.
inline float asDistance(float depth) {
    return depth == 0 ? std::numeric_limits<float>::infinity() : depth;
}

struct WindowRange {
    DepthImage nearest, farthest;  // model units; infinite where there is no surface
};

// The least and the greatest distance within `reach` px (>= 0) of each pixel, in a square window, cut off at
// the picture's borders.
WindowRange windowRange(const DepthImage& depth, int reach);

}  // namespace iwalk::tools
