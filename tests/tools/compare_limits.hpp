#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "tests/tools/compare.hpp"

namespace iwalk::tools {

// How many pixels may be so: a number of pixels, or a share of all of them.
struct PixelLimit {
    std::uint64_t pixels = 0;
    std::optional<double> percent;  // 0..100; counts instead of `pixels` when present

    std::uint64_t of(std::uint64_t allPixels) const;
};

// "12" (pixels) or "0.5%" (of the picture's pixels).
Result<PixelLimit> parsePixelLimit(const std::string& text);

// What is asked for; what is not present is not asked for.
struct Limits {
    std::optional<PixelLimit> different;   // pixels that differ in colour or depth bits
    std::optional<PixelLimit> ties;        // when present, ties are limited by this and not by `different`
    std::optional<PixelLimit> outside;     // pixels outside the reference's depth range
    std::optional<PixelLimit> seeThrough;  // pixels farther than it
};

// One sentence for each limit that is broken; empty when the comparison is within what was asked.
std::vector<std::string> brokenLimits(const Comparison& comparison, const Limits& limits);

}  // namespace iwalk::tools
