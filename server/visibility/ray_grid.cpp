#include "server/visibility/ray_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>

namespace iwalk {
namespace {

constexpr std::size_t kPacket = 32;          // rays that are tested against a box at once
constexpr float kLeastContribution = 1e-6f;  // so that what lies far behind still has an order
constexpr double kLeastSide = 0.01;          // cells: of a box that is seen edge-on

// A number in [0, 1) that depends on `n` alone (the finaliser of MurmurHash3).
double jitter(std::uint32_t n) {
    n ^= n >> 16, n *= 0x85ebca6bu, n ^= n >> 13, n *= 0xc2b2ae35u, n ^= n >> 16;
    return static_cast<double>(n) * 0x1p-32;
}

int cellsAlong(int pixels, double raysPerPixel) {
    return std::max(1, static_cast<int>(std::lround(pixels * std::sqrt(raysPerPixel))));
}

// A direction that is 0 along an axis would make 0 * infinity of a box's side; products with any lattice
// distance stay finite.
float inverseOf(double d) {
    constexpr double kLeast = 1e-18;
    return static_cast<float>(1 / (std::abs(d) < kLeast ? std::copysign(kLeast, d) : d));
}

// By value, so that loops of them become vector instructions.
float least(float a, float b) {
    return a < b ? a : b;
}
float greatest(float a, float b) {
    return a > b ? a : b;
}

}  // namespace

RayGrid::RayGrid(const ScreenProjection& projection, const PixelRect& tile, double near, double raysPerPixel)
    : columns_(cellsAlong(tile.width, raysPerPixel)),
      rows_(cellsAlong(tile.height, raysPerPixel)),
      near_(static_cast<float>(near)) {
    const double width = double(tile.width) / columns_, height = double(tile.height) / rows_;  // px
    glm::dmat3 fromPixels(1);
    fromPixels[0].x = 1 / width, fromPixels[1].y = 1 / height;
    fromPixels[2] = glm::dvec3(-tile.x / width, -tile.y / height, 1);
    toGrid_ = fromPixels * projection.toPixels;

    std::uint32_t random = 0;
    for (int row = 0; row < rows_; ++row)
        for (int column = 0; column < columns_; ++column) {
            const double x = tile.x + (column + jitter(random++)) * width;
            const double y = tile.y + (row + jitter(random++)) * height;
            const glm::dvec3 direction = projection.toDirection * glm::dvec3(x, y, 1);
            for (std::size_t axis = 0; axis < 3; ++axis) inverse_[axis].push_back(inverseOf(direction[axis]));
            length_.push_back(static_cast<float>(glm::length(direction)));
        }
    contribution_.assign(length_.size(), 1);
}

// The cells that the box's rectangle meets; all of them when the box is not all in front of the eye.
RayGrid::Cells RayGrid::cellsOf(const EyeBox& box) const {
    glm::dvec2 low(0), high(0);
    for (unsigned corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                           corner & 4 ? box.high.z : box.low.z);
        const glm::dvec3 q = toGrid_ * p;
        if (q.z <= near_) return {0, columns_, 0, rows_, 1};
        const glm::dvec2 place(q.x / q.z, q.y / q.z);
        low = corner == 0 ? place : glm::min(low, place);
        high = corner == 0 ? place : glm::max(high, place);
    }
    const glm::dvec2 end(columns_, rows_);
    low = glm::clamp(low, glm::dvec2(0), end);
    high = glm::clamp(high, glm::dvec2(0), end);
    const glm::dvec2 side = glm::max(high - low, glm::dvec2(kLeastSide));
    return {std::min(static_cast<int>(low.x), columns_ - 1), std::max(1, static_cast<int>(std::ceil(high.x))),
            std::min(static_cast<int>(low.y), rows_ - 1), std::max(1, static_cast<int>(std::ceil(high.y))),
            static_cast<float>(side.x * side.y)};
}

// Calls meet(ray, length of the ray in the box) for the rays that meet the box.
template <class Meet>
RayGrid::Arrival RayGrid::forRays(const EyeBox& box, const Meet& meet) const {
    const Cells cells = cellsOf(box);
    Arrival arrival;
    float around = 0;  // contribution of all rays of the cells
    std::array<float, kPacket> enter, leave;
    for (int row = cells.top; row < cells.bottom; ++row) {
        const std::size_t begin = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
        const std::size_t end = begin + static_cast<std::size_t>(cells.right);
        for (std::size_t first = begin + static_cast<std::size_t>(cells.left); first < end;
             first += kPacket) {
            const std::size_t count = std::min(kPacket, end - first);
            const float *const x = &inverse_[0][first], *const y = &inverse_[1][first],
                               *const z = &inverse_[2][first];
            for (std::size_t i = 0; i < count; ++i) {
                const float x0 = box.low.x * x[i], x1 = box.high.x * x[i];
                const float y0 = box.low.y * y[i], y1 = box.high.y * y[i];
                const float z0 = box.low.z * z[i], z1 = box.high.z * z[i];
                enter[i] = greatest(greatest(least(x0, x1), least(y0, y1)), greatest(least(z0, z1), near_));
                leave[i] = least(least(greatest(x0, x1), greatest(y0, y1)), greatest(z0, z1));
            }
            for (std::size_t i = 0; i < count; ++i) {
                around += contribution_[first + i];
                if (leave[i] < enter[i]) continue;
                ++arrival.rays;
                arrival.contribution += contribution_[first + i];
                meet(first + i, (leave[i] - enter[i]) * length_[first + i]);
            }
        }
    }
    if (arrival.rays > 0) return arrival;
    const auto count = static_cast<float>((cells.right - cells.left) * (cells.bottom - cells.top));
    return {0, around / count * std::min(cells.area, 1.0f)};
}

RayGrid::Arrival RayGrid::arrivingAt(const EyeBox& box) const {
    return forRays(box, [](std::size_t, float) {});
}

RayGrid::Arrival RayGrid::pass(const EyeBox& box, float density) {
    return forRays(box, [&](std::size_t ray, float length) {
        contribution_[ray] = greatest(contribution_[ray] * std::exp(-density * length), kLeastContribution);
    });
}

}  // namespace iwalk
