#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "common/image.hpp"

namespace iwalk {

// Pictures that need not be exact (common/image.hpp has those that must). RGB of 8 bits.
Result<std::vector<std::byte>> encodeJpeg(const ColorImage& image);
// From anybody: what is no JPEG, or has more than `mostPixels`, is refused before memory is taken for it.
Result<ColorImage> decodeJpeg(std::span<const std::byte> bytes, std::size_t mostPixels);

}  // namespace iwalk
