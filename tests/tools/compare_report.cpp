#include "tests/tools/compare_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace iwalk::tools {
namespace {

using nlohmann::json;

double share(std::uint64_t count, const Comparison& comparison) {
    return static_cast<double>(count) / static_cast<double>(comparison.pixels());
}

// "12 (0.0015 %)"
std::string withShare(std::uint64_t count, const Comparison& comparison) {
    return fmt::format("{} ({:.4g} %)", count, 100 * share(count, comparison));
}

std::string place(const char* what, const std::optional<Pixel>& pixel) {
    return pixel ? fmt::format(", {} at column {}, row {}", what, (*pixel)[0], (*pixel)[1]) : "";
}

json pixelJson(const std::optional<Pixel>& pixel) {
    return pixel ? json(*pixel) : json(nullptr);
}

json colorJson(const Comparison& comparison) {
    const ColorMeasures& color = comparison.color;
    const std::uint64_t correct = comparison.pixels() - color.different;
    return {{"different_pixels", color.different},
            {"correct_pixels", correct},
            {"correct_share", share(correct, comparison)},
            {"largest_channel_difference", color.largestDifference},
            {"psnr_db", std::isfinite(color.psnrDb) ? json(color.psnrDb) : json(nullptr)},
            {"first_different", pixelJson(color.firstDifferent)}};
}

json rangeJson(const Comparison& comparison) {
    const RangeMeasures& range = *comparison.range;
    return {{"window_px", range.windowPx},
            {"outside_pixels", range.outside},
            {"outside_share", share(range.outside, comparison)},
            {"see_through_pixels", range.seeThrough},
            {"see_through_share", share(range.seeThrough, comparison)},
            {"first_outside", pixelJson(range.firstOutside)}};
}

std::string rangeText(const Comparison& comparison) {
    const RangeMeasures& range = *comparison.range;
    return fmt::format("range:   {} outside the reference's depths in {} x {} px, {} of them see-through{}\n",
                       withShare(range.outside, comparison), range.windowPx, range.windowPx,
                       withShare(range.seeThrough, comparison), place("first", range.firstOutside));
}

}  // namespace

std::string textReport(const Comparison& comparison, const std::vector<std::string>& broken) {
    const ColorMeasures& color = comparison.color;
    std::string text =
        fmt::format("picture: {} x {} px, {} pixels, {} different\n", comparison.width, comparison.height,
                    comparison.pixels(), withShare(comparison.different, comparison));
    text += fmt::format(
        "colour:  {} different, {} correct, largest channel difference {}, PSNR {:.2f} dB{}\n",
        withShare(color.different, comparison), withShare(comparison.pixels() - color.different, comparison),
        color.largestDifference, color.psnrDb, place("first", color.firstDifferent));
    if (comparison.depth) {
        text += fmt::format("depth:   {} different in bits, {} ties (equal depth, other colour)\n",
                            withShare(comparison.depth->different, comparison),
                            withShare(comparison.depth->ties, comparison));
    }
    if (comparison.range) text += rangeText(comparison);
    for (const std::string& limit : broken) text += fmt::format("not within what was asked: {}\n", limit);
    return broken.empty() ? text + "within what was asked\n" : text;
}

std::string jsonReport(const Comparison& comparison, const std::vector<std::string>& broken) {
    json report = {{"width_px", comparison.width},   {"height_px", comparison.height},
                   {"pixels", comparison.pixels()},  {"different_pixels", comparison.different},
                   {"color", colorJson(comparison)}, {"within", broken.empty()},
                   {"broken_limits", broken}};
    if (comparison.depth) {
        report["depth"] = {{"different_pixels", comparison.depth->different},
                           {"ties", comparison.depth->ties}};
    }
    if (comparison.range) report["range"] = rangeJson(comparison);
    return report.dump(2) + "\n";
}

}  // namespace iwalk::tools
