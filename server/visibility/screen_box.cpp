#include "server/visibility/screen_box.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/matrix.hpp>

namespace iwalk {
namespace {

// The shader rounds three coordinates, three of the matrix, three products and two sums to 24 bits; relative
// to the sum of the products' sizes that is less than 8 * 2^-24.
constexpr double kRowError = 0x1p-21;
// Near plane, division and result of a depth.
constexpr double kDepthError = 0x1p-22;
// px: the shader and the rasteriser each snap to 1/256, the clipper's new corners to as much.
constexpr double kSnap = 1.0 / 128;
// Window positions as floats of clip space, and back.
constexpr double kWindowError = 0x1p-21;

glm::dmat3 absolute(const glm::dmat3& m) {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

struct Extent {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void add(double x) { low = std::min(low, x), high = std::max(high, x); }
};

// The pixels of [from, from + count), counted from `from`, whose centres lie in the extent grown by how far
// off its ends may be drawn.
void pixelsOf(Extent extent, double error, double depthError, int from, int count, int& first, int& end) {
    const double largest = std::max(std::abs(extent.low), std::abs(extent.high));
    const double margin = kSnap + error + largest * (depthError + kWindowError);
    const double low = std::ceil(extent.low - margin - 0.5),
                 high = std::floor(extent.high + margin - 0.5) + 1;
    first = static_cast<int>(std::clamp<double>(low, from, from + count)) - from;
    end = static_cast<int>(std::clamp<double>(high, from, from + count)) - from;
}

}  // namespace

BoxProjection::BoxProjection(const ScreenProjection& projection, const PixelRect& part, double near)
    : toPixels_(projection.toPixels),
      errors_(absolute(projection.toPixels) * kRowError),
      part_(part),
      near_(near * (1 + kDepthError)) {}

ScreenBox BoxProjection::of(const glm::dvec3& low, const glm::dvec3& high) const {
    const glm::dvec3 start = toPixels_ * low;
    const glm::dvec3 error = errors_ * glm::max(glm::abs(low), glm::abs(high));
    glm::dvec3 edges[3];
    double nearest = start.z - error.z;
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        edges[axis] = toPixels_[axis] * (high[axis] - low[axis]);
        nearest += std::min(0.0, edges[axis].z);
    }
    if (!(nearest > near_)) return {0, 0, part_.width, part_.height, ScreenBox::kAtTheEye};

    Extent x, y;
    for (unsigned corner = 0; corner < 8; ++corner) {
        glm::dvec3 q = start;
        for (glm::length_t axis = 0; axis < 3; ++axis)
            if (corner >> axis & 1) q += edges[axis];
        const double over = 1 / q.z;
        x.add(q.x * over);
        y.add(q.y * over);
    }
    ScreenBox box;
    pixelsOf(x, error.x / nearest, error.z / nearest, part_.x, part_.width, box.left, box.right);
    pixelsOf(y, error.y / nearest, error.z / nearest, part_.y, part_.height, box.top, box.bottom);
    box.depth = static_cast<float>(near_ / nearest);
    return box;
}

}  // namespace iwalk
