#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "common/camera_path.hpp"
#include "common/image.hpp"
#include "tests/tools/bvh.hpp"

// The judge of what the servers draw: double precision, on the CPU, sharing nothing with the GL pipeline.
namespace iwalk::tools {

inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

// Depth is the ray's parameter: a point of the ray is origin + depth * direction. Model units where the
// direction has a component of 1 along the view axis.
struct Ray {
    glm::dvec3 origin, direction;
};

struct Hit {
    double depth = 0;  // 0: nothing was hit
    std::uint32_t triangle = kNoTriangle;
    bool operator==(const Hit&) const = default;
};

// The rays through the centres of a picture's pixels; rows from the top.
class PixelRays {
  public:
    // `camera` sees the whole picture of width x height px (checkCamera).
    PixelRays(const Camera& camera, int width, int height);
    // Through column x, row y; depth along it is eye-space depth, perpendicular to the screen.
    Ray ray(int x, int y) const;

  private:
    glm::dvec3 eye_, forward_, right_, up_;  // right_ and up_: half the picture's height at depth 1
    double width_, height_;
};

class RayCaster {
  public:
    // Finite corners.
    explicit RayCaster(std::vector<Triangle> triangles);
    // The nearest triangle at a depth > 0 and >= nearDepth; of several at one depth the first in the list. A
    // ray through an edge or a corner that triangles share does not slip through between them. Thread-safe.
    Hit cast(const Ray& ray, double nearDepth) const;

  private:
    Bvh bvh_;
    std::vector<Triangle> leaves_;  // in the order of bvh_.order
};

struct CastPicture {
    Image<double> depth;            // 1 channel, model units, 0 where there is no surface
    Image<std::uint32_t> triangle;  // 1 channel, index or kNoTriangle
};

// Casts a ray through every pixel, on `threads` threads (0: one for each core).
CastPicture castPicture(const RayCaster& caster, const Camera& camera, int width, int height,
                        double nearDepth, unsigned threads = 0);

}  // namespace iwalk::tools
