#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/image.hpp"

// The measures by which two pictures of the same view are compared (docs: Measures).
namespace iwalk::tools {

// A rendered frame: colour, and depth where it was captured. Both of one size.
struct Picture {
    ColorImage color;
    DepthImage depth;  // no pixels: not captured
    bool hasDepth() const { return !depth.pixels.empty(); }
};

using Pixel = std::array<int, 2>;  // column from the left, row from the top

// Colour is compared exactly, channel by channel, in sRGB as stored.
struct ColorMeasures {
    std::uint64_t different = 0;          // pixels with any channel different; the others are 'correct'
    int largestDifference = 0;            // of any channel of any pixel, 0..255
    double psnrDb = 0;                    // over all channels; infinite for equal images
    std::optional<Pixel> firstDifferent;  // in reading order
};

// The same pipeline must give the same bits.
struct DepthMeasures {
    std::uint64_t different = 0;  // pixels whose depth bits differ
    std::uint64_t ties = 0;       // pixels with equal depth bits, but another colour
};

// A coarser picture must show the reference's surfaces, a little displaced.
struct RangeOptions {
    double tolerancePx =
        0;  // t: how far a surface may be displaced; the window reaches ceil(t) px to each side
    double depthSlack = 0;  // the range is widened at both ends by this share of the depth there, >= 0
};
struct RangeMeasures {
    int windowPx = 1;              // side of the square window in the reference
    std::uint64_t outside = 0;     // pixels whose depth is outside [min, max] of the reference's window
    std::uint64_t seeThrough = 0;  // among these, farther than the max; no surface is infinitely far
    std::optional<Pixel> firstOutside;
};

struct Comparison {
    int width = 0, height = 0;    // px
    std::uint64_t different = 0;  // pixels that differ in colour or, where there is depth, in depth bits
    ColorMeasures color;
    std::optional<DepthMeasures> depth;  // when both pictures have depth
    std::optional<RangeMeasures> range;  // when asked for and both pictures have depth

    std::uint64_t pixels() const {
        return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    }
};

// Both of one size; depths finite and not negative. `range` needs depth in both.
Comparison compare(const Picture& reference, const Picture& test, const std::optional<RangeOptions>& range);

}  // namespace iwalk::tools
