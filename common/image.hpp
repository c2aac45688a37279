#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

// Pixels in memory: rows from the top, channels interleaved.
template <class T>
struct Image {
    int width = 0, height = 0, channels = 0;
    std::vector<T> pixels;  // width * height * channels

    Image() = default;
    Image(int w, int h, int c) : width(w), height(h), channels(c) {
        pixels.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) *
                      static_cast<std::size_t>(c));
    }
    T* at(int x, int y) {
        return pixels.data() +
               (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
                   static_cast<std::size_t>(channels);
    }
    const T* at(int x, int y) const { return const_cast<Image*>(this)->at(x, y); }
};

using ColorImage = Image<std::uint8_t>;  // 3 channels, sRGB
using DepthImage =
    Image<float>;  // 1 channel `Z`: eye-space depth in model units, 0 where there is no surface

// Compressed files in memory.
Result<std::vector<std::byte>> encodePng(const ColorImage& image);
Result<std::vector<std::byte>> encodeExr(const DepthImage& image);
// `name` is for messages. Only files like ours are read (image_header.hpp): RGB of 8 bits, one float channel
// Z in scanlines. Larger than 32768 x 32768 is refused.
Result<ColorImage> decodePng(std::span<const std::byte> bytes, const std::string& name);
Result<DepthImage> decodeExr(std::span<const std::byte> bytes, const std::string& name);

// Files; errors name them.
Result<ColorImage> readPng(const std::string& path);
Result<DepthImage> readExr(const std::string& path);

}  // namespace iwalk
