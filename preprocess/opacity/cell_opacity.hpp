#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "common/dataset/opacity.hpp"
#include "preprocess/opacity/raster.hpp"

// How much of a cell's silhouette its content covers, from 20 directions: Correa 2004, section 3.2. The cell
// is rasterised in 'green' and what is in it in 'red' without depth; the coefficient is red / (red + green),
// the share of parallel rays through the cell that are blocked in it.
//
// Departures: the views are orthographic, as the coefficient stands for all viewpoints in a direction; so
// opposite views are mirror images, and 10 masks of 64 x 64 pixels give the 20 coefficients, those of
// opposite directions equal. Pixels are sampled at their centres: a triangle smaller than a pixel covers one
// as often as its area says, so the share is right on average however small triangles are.
namespace iwalk {

class CellOpacity {
  public:
    // Forgets all triangles.
    void clear();
    // Adds triangles, 3 corners each, in units of the cell: it is [0, 1]^3, closed. Only what is inside it
    // counts. Neighbours leave no gap between them where their corners are equal to the last bit. Triangles
    // with corners that are not finite are left out. The result depends neither on order nor on how triangles
    // are shared out among calls, and is the same on every machine.
    void add(std::span<const glm::vec3> corners);
    // In the order of kOpacityDirection: 0..255 for 0..1, to the nearest, but 0 only when no pixel is covered
    // and 255 only when all are.
    std::array<std::uint8_t, kOpacityDirections> coefficients() const;

  private:
    void addClipped(std::span<const glm::vec3, 3> triangle);
    void skipFullMasks();

    std::array<OpacityMask, kOpacityAxes> masks_{};
    std::uint32_t open_ = kAllOpacityAxes;  // bit i: mask i still has pixels to cover
};

}  // namespace iwalk
