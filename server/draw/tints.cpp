#include "server/draw/tints.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace iwalk {
namespace {

std::uint32_t packed(double red, double green, double blue) {
    const auto byte = [](double value) { return static_cast<std::uint32_t>(std::lround(255 * value)); };
    return byte(red) | byte(green) << 8 | byte(blue) << 16 | 0xff000000u;
}

// From blue over green to red.
std::uint32_t rainbow(double part) {
    const auto hill = [&](double centre) { return std::clamp(1.5 - std::abs(4 * part - centre), 0.0, 1.0); };
    return packed(hill(4) + (part > 0.75 ? 0.5 : 0) * (1 - hill(4)), hill(2), hill(0));
}

// A colour of its own for nearly every number.
std::uint32_t anyColor(std::uint32_t number) {
    std::uint32_t h = number * 0x9e3779b9u;
    h = (h ^ h >> 16) * 0x85ebca6bu;
    const double turn = 2 * std::numbers::pi * static_cast<double>(h >> 8) / 0x1p24;
    const double light = 0.35 + 0.35 * static_cast<double>(h & 0xff) / 255;
    const auto channel = [&](double shift) { return light + 0.3 * std::cos(turn + shift); };
    return packed(channel(0), channel(2.1), channel(4.2));
}

}  // namespace

Tints::Tints(const Hierarchy& hierarchy, Show show) : show_(show) {
    if (show != Show::levels) return;
    levels_.resize(hierarchy.pages.size());
    for (const LevelRecord& entry : hierarchy.entries) {
        std::fill_n(levels_.begin() + entry.firstPage, entry.pageCount, entry.level);
        if (entry.level != kFullLevel) finest_ = std::max<unsigned>(finest_, entry.level);
    }
}

std::uint32_t Tints::of(const ResidentPage& page, const DrawnRange& range) const {
    if (show_ == Show::ranges) return anyColor(page.page * 65537 + range.range);
    if (show_ == Show::priority) return rainbow(1 - range.turn / (kTurns - 1.0));
    if (show_ == Show::cache) return page.fetched ? packed(0.9, 0.25, 0.2) : packed(0.3, 0.75, 0.3);
    const std::uint8_t level = levels_[page.page];
    return level == kFullLevel ? packed(0.75, 0.75, 0.75)
                               : rainbow(level / std::max(1.0, double{1} * finest_));
}

}  // namespace iwalk
