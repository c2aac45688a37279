#include "tests/tools/compare.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "tests/tools/window_range.hpp"

namespace iwalk::tools {
namespace {

template <class T>
Pixel pixelAt(const Image<T>& image, std::size_t i) {
    const auto width = static_cast<std::size_t>(image.width);
    return {static_cast<int>(i % width), static_cast<int>(i / width)};
}

bool sameColor(const Picture& a, const Picture& b, std::size_t pixel) {
    return std::equal(&a.color.pixels[3 * pixel], &a.color.pixels[3 * pixel] + 3, &b.color.pixels[3 * pixel]);
}

bool sameDepthBits(const Picture& a, const Picture& b, std::size_t pixel) {
    return std::bit_cast<std::uint32_t>(a.depth.pixels[pixel]) ==
           std::bit_cast<std::uint32_t>(b.depth.pixels[pixel]);
}

double psnrOf(std::uint64_t squares, std::size_t samples) {
    if (squares == 0) return std::numeric_limits<double>::infinity();
    return 10 * std::log10(255.0 * 255.0 * static_cast<double>(samples) / static_cast<double>(squares));
}

ColorMeasures measureColor(const Picture& reference, const Picture& test) {
    ColorMeasures measures;
    std::uint64_t squares = 0;
    const std::vector<std::uint8_t>&a = reference.color.pixels, &b = test.color.pixels;
    for (std::size_t i = 0; i < a.size(); i += 3) {
        if (sameColor(reference, test, i / 3)) continue;
        if (measures.different++ == 0) measures.firstDifferent = pixelAt(reference.color, i / 3);
        for (std::size_t channel = i; channel < i + 3; ++channel) {
            const int difference = std::abs(a[channel] - b[channel]);
            measures.largestDifference = std::max(measures.largestDifference, difference);
            squares += static_cast<std::uint64_t>(difference * difference);
        }
    }
    measures.psnrDb = psnrOf(squares, a.size());
    return measures;
}

DepthMeasures measureDepth(const Picture& reference, const Picture& test) {
    DepthMeasures measures;
    for (std::size_t i = 0; i < reference.depth.pixels.size(); ++i) {
        const bool depthSame = sameDepthBits(reference, test, i);
        measures.different += depthSame ? 0 : 1;
        measures.ties += depthSame && !sameColor(reference, test, i) ? 1 : 0;
    }
    return measures;
}

RangeMeasures measureRange(const DepthImage& reference, const DepthImage& test, const RangeOptions& options) {
    const int reach = static_cast<int>(std::ceil(options.tolerancePx));
    const WindowRange window = windowRange(reference, reach);
    RangeMeasures measures;
    measures.windowPx = 2 * reach + 1;
    for (std::size_t i = 0; i < test.pixels.size(); ++i) {
        const double depth = asDistance(test.pixels[i]);
        const bool tooNear = depth < window.nearest.pixels[i] * (1 - options.depthSlack);
        const bool tooFar = depth > window.farthest.pixels[i] * (1 + options.depthSlack);
        if (!tooNear && !tooFar) continue;
        if (measures.outside++ == 0) measures.firstOutside = pixelAt(test, i);
        measures.seeThrough += tooFar ? 1 : 0;
    }
    return measures;
}

}  // namespace

Comparison compare(const Picture& reference, const Picture& test, const std::optional<RangeOptions>& range) {
    CHECK_OP(reference.color.width, ==, test.color.width);
    CHECK_OP(reference.color.height, ==, test.color.height);
    Comparison result;
    result.width = reference.color.width;
    result.height = reference.color.height;
    result.color = measureColor(reference, test);
    result.different = result.color.different;
    if (reference.hasDepth() && test.hasDepth()) {
        result.depth = measureDepth(reference, test);
        // A pixel of another colour is a tie or has another depth, too.
        result.different = result.depth->different + result.depth->ties;
    }
    if (range) {
        CHECK(result.depth.has_value());
        CHECK_OP(range->tolerancePx, >=, 0);
        result.range = measureRange(reference.depth, test.depth, *range);
    }
    return result;
}

}  // namespace iwalk::tools
