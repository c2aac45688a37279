#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "preprocess/generate/ply_output.hpp"

namespace iwalk {

// The outline of a part that is swept through space: counter-clockwise, with triangles that close it.
struct Profile {
    std::vector<glm::dvec2> points;  // metres
    std::vector<std::array<std::uint32_t, 3>> cap;
};

// Where a profile's axes lie at one place of a sweep. The sweep goes towards cross(u, v).
struct Ring {
    glm::dvec3 center{0}, u{0}, v{0};  // metres; the axes' lengths scale the profile
};

enum class Pass { vertices, triangles };

// Parts go through it twice, in the same order: once for their vertices, once for their triangles. Only what
// the pass wants is computed.
class PartWriter {
  public:
    PartWriter(PlyOutput& output, Pass pass) : output_(output), pass_(pass) {}

    // The closed surface of a profile that moves from ring to ring; two rings at least.
    void sweep(const Profile& profile, std::span<const Ring> rings, Rgb color);
    // The same where the last ring is followed by the first; three rings at least.
    void sweepAround(const Profile& profile, std::span<const Ring> rings, Rgb color);

    std::uint64_t triangles() const { return triangles_; }  // so far, in either pass
    Result<void> status() const { return output_.status(); }

  private:
    void vertices(const Profile& profile, std::span<const Ring> rings, Rgb color);
    void sides(std::uint32_t from, std::uint32_t to, std::uint32_t count);

    PlyOutput& output_;
    Pass pass_;
    std::uint32_t next_ = 0;  // vertex
    std::uint64_t triangles_ = 0;
};

}  // namespace iwalk
