#pragma once

#include <array>
#include <cstddef>

#include "common/dataset/opacity.hpp"

namespace iwalk {

inline constexpr std::size_t kOpacityPixels = 64;  // width and height of a mask
// Corners are snapped to 1/256 pixel: edge functions are then exact in 32-bit integers.
inline constexpr int kSubpixelBits = 8;
// Views side by side for vector instructions, and groups of them. Those past the last see a point.
inline constexpr std::size_t kOpacityLanes = 4;
inline constexpr std::size_t kOpacityGroups = (kOpacityAxes + kOpacityLanes - 1) / kOpacityLanes;

// Some orthographic views of a cell, one a lane. Subpixel coordinates of point p of the cell, rounded down
// from here: x[0] * p.x + x[1] * p.y + x[2] * p.z + x[3], likewise y. The whole cell lies inside the mask.
struct OpacityViews {
    using Rows = std::array<std::array<float, kOpacityLanes>, 4>;
    alignas(64) Rows x;
    alignas(64) Rows y;
};

// View i is lane i % kOpacityLanes of group i / kOpacityLanes.
const std::array<OpacityViews, kOpacityGroups>& opacityViews();

}  // namespace iwalk
