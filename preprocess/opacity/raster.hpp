#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "preprocess/opacity/views.hpp"

namespace iwalk {

// Row y, bit x: the pixel in column x is covered.
using OpacityMask = std::array<std::uint64_t, kOpacityPixels>;

inline constexpr std::uint32_t kAllOpacityAxes = (1u << kOpacityAxes) - 1;

// Covers the pixels whose centres a triangle inside the cell contains, in mask i for each bit i of `axes`, as
// seen in opacityViews(). A centre on an edge belongs to the side that it would be on if moved a little to
// the right, and up by less: so triangles that meet in an edge cover each centre on it once.
void coverPixels(std::span<const glm::vec3, 3> triangle, std::uint32_t axes,
                 std::array<OpacityMask, kOpacityAxes>& masks);

}  // namespace iwalk
