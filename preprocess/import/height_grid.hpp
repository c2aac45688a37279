#pragma once

#include <span>

#include "preprocess/import/height_ramp.hpp"
#include "preprocess/import/importer.hpp"
#include "preprocess/import/triangle_output.hpp"

namespace iwalk {

// Where the samples of a height map lie: columns along x, rows along y, the first row farthest from the
// origin, as north is on a map. What is not finite, or has the height that stands for it, is a hole.
class HeightGrid {
  public:
    HeightGrid(std::uint64_t columns, std::uint64_t rows, const ImportChoices& choices)
        : columns_(columns), rows_(rows), choices_(choices) {}

    // Its z is NaN at a hole.
    glm::dvec3 point(std::uint64_t column, std::uint64_t row, float height) const;
    // The triangles between row - 1 and `row`: two for four samples, one for three. They face upwards.
    // Coloured by `ramp`, if it is not null.
    Result<void> strip(std::uint64_t row, std::span<const float> above, std::span<const float> heights,
                       const HeightRamp* ramp, TriangleOutput& output) const;

  private:
    std::uint64_t columns_, rows_;
    ImportChoices choices_;
};

}  // namespace iwalk
