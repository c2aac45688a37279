#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <limits>

#include "server/wall/projection.hpp"

namespace iwalk {

// What the triangles in a box may touch of a block: pixels whose centres they may cover, and the nearest
// depth that their corners may have.
struct ScreenBox {
    static constexpr float kAtTheEye = std::numeric_limits<float>::infinity();  // nothing is nearer
    int left = 0, top = 0, right = 0, bottom = 0;  // px of the block's part: [left, right) x [top, bottom)
    float depth = 0;  // as in the depth buffer: 1 at the near plane, 0 infinitely far

    bool empty() const { return left >= right || top >= bottom; }
};

// Projects boxes for one block of one view. What floats in the shader, snapping to 1/256 px and clipping can
// change is bounded and added, so that what a ScreenBox says is true of every triangle in the box.
class BoxProjection {
  public:
    // `part`: px of the screen, what of it is drawn; ScreenBoxes count from its corner. `near`: in the unit
    // of the boxes.
    BoxProjection(const ScreenProjection& projection, const PixelRect& part, double near);

    // Corners from the eye, model axes. A box that reaches before the near plane may cover all of the block
    // and is at the eye.
    ScreenBox of(const glm::dvec3& low, const glm::dvec3& high) const;

  private:
    const glm::dmat3 toPixels_, errors_;  // errors_: of toPixels_ * v, for the sizes of v
    const PixelRect part_;
    const double near_;
};

}  // namespace iwalk
