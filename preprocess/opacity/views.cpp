#include "preprocess/opacity/views.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace iwalk {
namespace {

// What the cell's projection fills of a mask's side; the rest keeps rounding inside the mask.
constexpr double kFilled = 63.9 / 64;
// Pixel rows lie askew to the model's axes, so that plates and pipes along an axis are not sampled all alike.
const glm::dvec3 kAskew{0.48, 0.6, 0.64};

// Half the extent of the unit cube along a direction.
double halfExtent(const glm::dvec3& axis) {
    return 0.5 * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
}

// The coefficients of one image axis; adding one half rounds to the nearest subpixel.
void setRow(OpacityViews::Rows& rows, std::size_t lane, const glm::dvec3& axis) {
    const double center = 0.5 * kOpacityPixels * (1 << kSubpixelBits);
    const double offset = center + 0.5 - 0.5 * (axis.x + axis.y + axis.z);
    for (std::size_t i = 0; i < 3; ++i) rows[i][lane] = static_cast<float>(axis[i]);
    rows[3][lane] = static_cast<float>(offset);
}

void setView(OpacityViews& views, std::size_t lane, const glm::dvec3& direction) {
    const glm::dvec3 right = glm::normalize(glm::cross(kAskew, direction));
    const glm::dvec3 up = glm::cross(direction, right);
    const double half = 0.5 * kFilled * kOpacityPixels * (1 << kSubpixelBits);
    const double scale = half / std::max(halfExtent(right), halfExtent(up));
    setRow(views.x, lane, scale * right);
    setRow(views.y, lane, scale * up);
}

std::array<OpacityViews, kOpacityGroups> makeViews() {
    std::array<OpacityViews, kOpacityGroups> groups{};
    for (std::size_t i = 0; i < kOpacityAxes; ++i) {
        const glm::dvec3 direction = glm::normalize(glm::dvec3(kOpacityDirection[i]));
        setView(groups[i / kOpacityLanes], i % kOpacityLanes, direction);
    }
    return groups;
}

}  // namespace

const std::array<OpacityViews, kOpacityGroups>& opacityViews() {
    static const auto views = makeViews();
    return views;
}

}  // namespace iwalk
