#pragma once

#include <cstdint>

#include "common/image.hpp"

namespace iwalk {

// Makes a small picture of a large one on the GPU, so that only the small one is read back.
class Thumbnail {
  public:
    Thumbnail() = default;
    ~Thumbnail();
    Thumbnail(const Thumbnail&) = delete;
    Thumbnail& operator=(const Thumbnail&) = delete;

    // `framebuffer` (a GL name) has `width` x `height` px of colour, its first row at the top; the result is
    // at most as large.
    ColorImage read(std::uint32_t framebuffer, int width, int height, int smallWidth, int smallHeight);

  private:
    void prepare(int width, int height, int levels);

    std::uint32_t texture_ = 0, framebuffer_ = 0;  // GL names
    int width_ = 0, height_ = 0, levels_ = 0;      // of the texture
};

}  // namespace iwalk
