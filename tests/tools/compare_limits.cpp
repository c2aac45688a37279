#include "tests/tools/compare_limits.hpp"

#include <charconv>
#include <string_view>
#include <system_error>

namespace iwalk::tools {
namespace {

// The whole text as a number, nothing before or after it.
template <class T>
std::optional<T> parseNumber(std::string_view text) {
    T value{};
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
}

}  // namespace

std::uint64_t PixelLimit::of(std::uint64_t allPixels) const {
    return percent ? static_cast<std::uint64_t>(*percent / 100 * static_cast<double>(allPixels)) : pixels;
}

Result<PixelLimit> parsePixelLimit(const std::string& text) {
    const bool isShare = text.ends_with('%');
    if (isShare) {
        const auto percent = parseNumber<double>(std::string_view(text).substr(0, text.size() - 1));
        if (percent && *percent >= 0 && *percent <= 100) return PixelLimit{0, *percent};
    } else if (const auto pixels = parseNumber<std::uint64_t>(text)) {
        return PixelLimit{*pixels, std::nullopt};
    }
    return fail("'{}' is not a number of pixels (12) or a share of them (0.5%)", text);
}

std::vector<std::string> brokenLimits(const Comparison& comparison, const Limits& limits) {
    std::vector<std::string> broken;
    auto limit = [&](std::uint64_t count, const std::optional<PixelLimit>& most, const char* what,
                     const char* option) {
        const std::uint64_t allowed = most ? most->of(comparison.pixels()) : count;
        if (count > allowed)
            broken.push_back(fmt::format("{} {}, allowed are {} ({})", count, what, allowed, option));
    };
    const std::uint64_t ties = comparison.depth ? comparison.depth->ties : 0;
    limit(limits.ties ? comparison.different - ties : comparison.different, limits.different, "pixels differ",
          "--different");
    limit(ties, limits.ties, "pixels are ties of depth", "--ties");
    if (comparison.range) {
        limit(comparison.range->outside, limits.outside, "pixels are outside the reference's depth range",
              "--outside");
        limit(comparison.range->seeThrough, limits.seeThrough, "pixels are see-through", "--see-through");
    }
    return broken;
}

}  // namespace iwalk::tools
