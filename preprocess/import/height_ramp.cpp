#include "preprocess/import/height_ramp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

namespace iwalk {
namespace {

// sRGB; at equal distances from the first, at 0, to the last, at 1.
using Stop = std::array<double, 3>;
constexpr std::array<Stop, 3> kSea{{{16, 42, 92}, {52, 110, 172}, {150, 200, 224}}};
constexpr std::array<Stop, 5> kLand{
    {{84, 138, 78}, {172, 188, 104}, {226, 200, 132}, {150, 110, 82}, {248, 248, 248}}};

std::uint32_t between(std::span<const Stop> stops, double at) {
    // What is no number, where the sea's level is infinite, counts as 0.
    const double place = (at > 0 ? std::min(at, 1.0) : 0) * static_cast<double>(stops.size() - 1);
    const std::size_t stop = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    const double part = place - static_cast<double>(stop);
    std::array<std::uint8_t, 4> bytes{0, 0, 0, 255};
    for (std::size_t i = 0; i < 3; ++i) {
        const double value = stops[stop][i] + (stops[stop + 1][i] - stops[stop][i]) * part;
        bytes[i] = static_cast<std::uint8_t>(std::lround(value));
    }
    std::uint32_t color = 0;
    std::memcpy(&color, bytes.data(), sizeof color);
    return color;
}

}  // namespace

std::uint32_t HeightRamp::color(double height) const {
    if (height > seaLevel_) return between(kLand, (height - seaLevel_) / (highest_ - seaLevel_));
    // Where there is nothing deeper than the sea's level all is shallow.
    return between(kSea, lowest_ < seaLevel_ ? (height - lowest_) / (seaLevel_ - lowest_) : 1);
}

}  // namespace iwalk
