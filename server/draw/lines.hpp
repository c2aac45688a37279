#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "common/result.hpp"

namespace iwalk {

// From the eye, steps; RGBA8 in memory order, sRGB.
struct Line {
    glm::dvec3 from, to;
    std::uint32_t color;
    float behind = 0.2f;  // opacity where a surface is before it
};

// Draws lines over a shaded picture.
class Lines {
  public:
    Lines() = default;
    ~Lines();
    Lines(const Lines&) = delete;
    Lines& operator=(const Lines&) = delete;

    Result<void> prepare();
    // Into the bound framebuffer, viewport and scissor; texture unit 1 has the depths of the block. The
    // program is in use after use(), for the caller to set its uniforms kToPixels, kNear, kWindow and
    // kInBlock.
    void use() const;
    void draw(std::span<const Line> lines) const;

  private:
    std::uint32_t program_ = 0, array_ = 0, buffer_ = 0;  // GL names
};

}  // namespace iwalk
