#include "preprocess/import/height_grid.hpp"

#include <array>
#include <limits>

#include "preprocess/import/vertex_output.hpp"

namespace iwalk {

glm::dvec3 HeightGrid::point(std::uint64_t column, std::uint64_t row, float height) const {
    const bool hole = choices_.noData && static_cast<double>(height) == *choices_.noData;
    return glm::dvec3(
        static_cast<double>(column) * choices_.spacing,
        static_cast<double>(rows_ - 1 - row) * choices_.spacing,
        hole ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(height) * choices_.heightScale);
}

Result<void> HeightGrid::strip(std::uint64_t row, std::span<const float> above,
                               std::span<const float> heights, const HeightRamp* ramp,
                               TriangleOutput& output) const {
    for (std::size_t column = 0; column + 1 < columns_; ++column) {
        // Around the cell, counter-clockwise seen from above.
        const std::array<glm::dvec3, 4> corners{
            point(column, row, heights[column]), point(column + 1, row, heights[column + 1]),
            point(column + 1, row - 1, above[column + 1]), point(column, row - 1, above[column])};
        output.begin();
        std::size_t samples = 0;
        for (const glm::dvec3& corner : corners) samples += isFinite(corner);
        for (const glm::dvec3& corner : corners) {
            if (samples < 3 || !isFinite(corner)) continue;
            const std::uint32_t color = ramp != nullptr ? ramp->color(corner.z) : 0;
            RETURN_IF_ERROR(output.corner({corner, color, glm::vec3(0)}));
        }
    }
    return {};
}

}  // namespace iwalk
