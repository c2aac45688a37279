#include "tests/tools/window_range.hpp"

#include <algorithm>

// Separable: rows, then columns as whole rows, so that the inner loops run over neighbours in memory and are
// vectorised. That is O(reach) a pixel, but for a reach of some pixels faster than van Herk's constant time.
namespace iwalk::tools {
namespace {

// out[i] = pick(out[i], in[i]) for `count` values.
template <class Pick>
void combine(float* out, const float* in, std::ptrdiff_t count, Pick pick) {
    for (std::ptrdiff_t i = 0; i < count; ++i) out[i] = pick(out[i], in[i]);
}

template <class Pick>
DepthImage alongRows(const DepthImage& in, int reach, Pick pick) {
    DepthImage out = in;
    for (int y = 0; y < in.height; ++y) {
        for (int shift = 1; shift <= std::min(reach, in.width - 1); ++shift) {
            combine(out.at(0, y), in.at(shift, y), in.width - shift, pick);
            combine(out.at(shift, y), in.at(0, y), in.width - shift, pick);
        }
    }
    return out;
}

template <class Pick>
DepthImage alongColumns(const DepthImage& in, int reach, Pick pick) {
    DepthImage out = in;
    for (int y = 0; y < in.height; ++y) {
        const int first = std::max(0, y - reach), last = std::min(in.height - 1, y + reach);
        for (int other = first; other <= last; ++other)
            combine(out.at(0, y), in.at(0, other), in.width, pick);
    }
    return out;
}

template <class Pick>
DepthImage inWindow(const DepthImage& in, int reach, Pick pick) {
    return alongColumns(alongRows(in, reach, pick), reach, pick);
}

}  // namespace

WindowRange windowRange(const DepthImage& depth, int reach) {
    DepthImage distance = depth;
    for (float& z : distance.pixels) z = asDistance(z);
    return {inWindow(distance, reach, [](float a, float b) { return a < b ? a : b; }),
            inWindow(distance, reach, [](float a, float b) { return a > b ? a : b; })};
}

}  // namespace iwalk::tools
