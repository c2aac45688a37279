#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "common/result.hpp"

namespace iwalk {

// What an image file says of itself, read before an image library sees the bytes: libraries allocate by what
// a header claims, print to standard error and leak when a file is damaged. What these pass is one of our
// kind, at most 32768 x 32768 pixels, and not more pixels than so many bytes can hold. `name` is for
// messages.

// PNG: 3 channels (RGB) of 8 bits; every chunk complete, with the right checksum, up to the end mark.
Result<void> checkPngHeader(std::span<const std::byte> bytes, const std::string& name);

// OpenEXR: one part in scanlines, 1 channel `Z` of 32-bit float, compressed with ZIP, ZIPS, RLE or not at
// all.
Result<void> checkExrHeader(std::span<const std::byte> bytes, const std::string& name);

}  // namespace iwalk
