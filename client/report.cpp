#include "client/report.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace iwalk::client {
namespace {

using json = nlohmann::ordered_json;

double quantile(const std::vector<double>& sorted, double share) {
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(std::floor(place));
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

FrameTimes quantiles(std::vector<double> times) {
    std::sort(times.begin(), times.end());
    return {quantile(times, 0.5), quantile(times, 0.01), quantile(times, 0.99)};
}

json tileReport(const protocol::TileStats& stats, const protocol::TileInfo& info) {
    return {{"tile", info.name},
            {"rank", info.rank},
            {"host", info.host},
            {"visibility_ms", stats.visibilityMs},
            {"adapt_ms", stats.adaptMs},
            {"fetch_wait_ms", stats.fetchWaitMs},
            {"draw_ms", stats.drawMs},
            {"barrier_wait_ms", stats.barrierWaitMs},
            {"guess_ms", stats.guessMs},
            {"pyramid_ms", stats.pyramidMs},
            {"test_ms", stats.testMs},
            {"triangles", stats.triangles},
            {"ranges", stats.ranges},
            {"guess_triangles", stats.guessTriangles},
            {"hidden_pages", stats.hiddenPages},
            {"hidden_ranges", stats.hiddenRanges},
            {"screen_error_px", stats.screenErrorPx},
            {"fetched_bytes", stats.fetchedBytes},
            {"prefetched_bytes", stats.prefetchedBytes},
            {"stalls", stats.stalls},
            {"bad_pages", stats.badPages}};
}

json frameReport(const PlayedFrame& frame, const protocol::Welcome& welcome) {
    json tiles = json::array();
    for (const protocol::TileStats& stats : frame.done.tiles) {
        tiles.push_back(tileReport(stats, welcome.tiles[stats.tile]));
    }
    return {{"frame", frame.frame},
            {"time_ms", frame.done.timeMs},
            {"camera_to_swap_ms", frame.latencyMs},
            {"tiles", std::move(tiles)}};
}

json settingsReport(const protocol::Welcome& welcome) {
    json settings = json::object();
    for (const protocol::NamedValue& setting : welcome.settings) settings[setting.name] = setting.value;
    return settings;
}

json timesReport(const std::optional<FrameTimes>& times) {
    if (!times) return {{"median", nullptr}, {"p01", nullptr}, {"p99", nullptr}};
    return {{"median", times->median}, {"p01", times->p01}, {"p99", times->p99}};
}

json summaryReport(const protocol::Welcome& welcome, const std::vector<PlayedFrame>& frames) {
    std::vector<std::uint64_t> peaks(welcome.tiles.size(), 0);
    for (const PlayedFrame& frame : frames) {
        for (const auto& stats : frame.done.tiles)
            peaks[stats.tile] = std::max(peaks[stats.tile], stats.peakRssBytes);
    }
    json tiles = json::array();
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        tiles.push_back(
            {{"tile", welcome.tiles[i].name}, {"rank", welcome.tiles[i].rank}, {"peak_rss_bytes", peaks[i]}});
    }
    const auto latency = frames.empty() ? std::nullopt : std::optional(latencies(frames));
    return {{"frame_ms", timesReport(frameTimes(frames))},
            {"camera_to_swap_ms", timesReport(latency)},
            {"tiles", std::move(tiles)}};
}

}  // namespace

std::optional<FrameTimes> frameTimes(const std::vector<PlayedFrame>& frames) {
    if (frames.size() < 2) return std::nullopt;
    std::vector<double> times;
    for (std::size_t i = 1; i < frames.size(); ++i) times.push_back(frames[i].done.timeMs);
    return quantiles(std::move(times));
}

FrameTimes latencies(const std::vector<PlayedFrame>& frames) {
    std::vector<double> times;
    for (const PlayedFrame& frame : frames) times.push_back(frame.latencyMs);
    return quantiles(std::move(times));
}

std::string reportText(const protocol::Welcome& welcome, const std::vector<PlayedFrame>& frames) {
    json report;
    report["version"] = welcome.serverVersion;
    report["dataset"] = {{"triangles", welcome.datasetTriangles}, {"bytes", welcome.datasetBytes}};
    report["wall"] = {
        {"width_px", welcome.wallWidth}, {"height_px", welcome.wallHeight}, {"tiles", welcome.tiles.size()}};
    report["settings"] = settingsReport(welcome);
    report["frames"] = json::array();
    for (const PlayedFrame& frame : frames) report["frames"].push_back(frameReport(frame, welcome));
    report["summary"] = summaryReport(welcome, frames);
    return report.dump(1) + "\n";
}

}  // namespace iwalk::client
