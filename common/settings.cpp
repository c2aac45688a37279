#include "common/settings.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace iwalk {
namespace {

// A number that is the whole of `text`; nothing when it is anything else or out of T's range.
template <class T, class... Base>
std::optional<T> wholeNumber(std::string_view text, Base... base) {
    T value{};
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value, base...);
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
}

struct ByteUnit {
    char letter;
    int shift;
};
constexpr std::array<ByteUnit, 4> kByteUnits{{{'T', 40}, {'G', 30}, {'M', 20}, {'k', 10}}};

// The shortest text that parseBytes reads as exactly `bytes`.
std::string exactBytes(std::uint64_t bytes) {
    for (const ByteUnit& unit : kByteUnits) {
        const std::uint64_t factor = std::uint64_t{1} << unit.shift;
        if (bytes != 0 && bytes % factor == 0) return fmt::format("{}{}", bytes / factor, unit.letter);
    }
    return fmt::format("{}", bytes);
}

constexpr std::uint64_t kMinCacheBytes = 64u << 10;  // 512 is a forgotten M, not a cache
constexpr std::uint32_t kMaxFetchThreads = 64;

Result<void> parseCache(Settings& settings, const std::string& text) {
    ASSIGN_OR_RETURN(const std::uint64_t bytes, parseBytes(text));
    if (bytes < kMinCacheBytes) return fail("{} is less than 64k", text);
    settings.cacheBytes = bytes;
    return {};
}

Result<void> parseFetchThreads(Settings& settings, const std::string& text) {
    const auto count = wholeNumber<std::uint32_t>(text);
    if (!count || *count < 1 || *count > kMaxFetchThreads)
        return fail("not a number from 1 to {}", kMaxFetchThreads);
    settings.fetchThreads = *count;
    return {};
}

Result<void> parseShading(Settings& settings, const std::string& text) {
    if (text == "flat") return settings.shading = Shading::flat, Result<void>();
    if (text == "smooth") return settings.shading = Shading::smooth, Result<void>();
    if (text == "auto") return settings.shading = Shading::automatic, Result<void>();
    return fail("choose flat, smooth or auto");
}

std::string shadingText(Shading shading) {
    return shading == Shading::flat ? "flat" : shading == Shading::smooth ? "smooth" : "auto";
}

Result<void> parseRamp(Settings& settings, const std::string& text) {
    if (text == "none") return settings.ramp = Ramp::none, Result<void>();
    if (text == "height") return settings.ramp = Ramp::height, Result<void>();
    if (text == "auto") return settings.ramp = Ramp::automatic, Result<void>();
    return fail("choose height, none or auto");
}

std::string rampText(Ramp ramp) {
    return ramp == Ramp::none ? "none" : ramp == Ramp::height ? "height" : "auto";
}

// The # may be left out: a shell takes it for a comment.
Result<void> parseBackground(Settings& settings, const std::string& text) {
    std::string_view digits = text;
    if (digits.starts_with('#')) digits.remove_prefix(1);
    const auto color = wholeNumber<std::uint32_t>(digits, 16);
    if (!color || digits.size() != 6) return fail("not six hexadecimal digits, as in 20242a");
    settings.background = *color;
    return {};
}

constexpr double kMaxNear = 1e15;

Result<void> parseNear(Settings& settings, const std::string& text) {
    const auto distance = wholeNumber<double>(text);
    if (!distance || !(*distance >= 0 && *distance <= kMaxNear)) {
        return fail("not a distance from 0 to {:.0e} in model units", kMaxNear);
    }
    settings.near = *distance;
    return {};
}

Result<void> parseLevel(Settings& settings, const std::string& text) {
    if (text == "full") return settings.level = kFullLevel, Result<void>();
    const auto level = wholeNumber<std::uint8_t>(text);
    if (!level || *level == kFullLevel) return fail("not a level from 0 to {}, nor full", kFullLevel - 1);
    settings.level = *level;
    return {};
}

std::string levelText(std::uint8_t level) {
    return level == kFullLevel ? "full" : fmt::format("{}", level);
}

Result<void> parseMode(Settings& settings, const std::string& text) {
    if (text == "frustum") return settings.mode = Mode::frustum, Result<void>();
    if (text == "plp") return settings.mode = Mode::plp, Result<void>();
    if (text == "cplp") return settings.mode = Mode::cplp, Result<void>();
    return fail("choose frustum, plp or cplp");
}

std::string modeText(Mode mode) {
    return mode == Mode::frustum ? "frustum" : mode == Mode::plp ? "plp" : "cplp";
}

Result<void> parseOcclusion(Settings& settings, const std::string& text) {
    if (text == "hzb") return settings.occlusion = OcclusionTest::hzb, Result<void>();
    if (text == "queries") return settings.occlusion = OcclusionTest::queries, Result<void>();
    return fail("choose hzb or queries");
}

std::string occlusionText(OcclusionTest occlusion) {
    return occlusion == OcclusionTest::hzb ? "hzb" : "queries";
}

constexpr std::uint64_t kMinPlpBudget = 1000;  // a range has up to 512

Result<void> parsePlpBudget(Settings& settings, const std::string& text) {
    const auto triangles = wholeNumber<std::uint64_t>(text);
    if (!triangles || *triangles < kMinPlpBudget)
        return fail("not a number of triangles, {} or more", kMinPlpBudget);
    settings.plpBudget = *triangles;
    return {};
}

constexpr double kMinPlpRays = 0.001, kMaxPlpRays = 10;

Result<void> parsePlpRays(Settings& settings, const std::string& text) {
    const auto percent = wholeNumber<double>(text);
    if (!percent || !(*percent >= kMinPlpRays && *percent <= kMaxPlpRays))
        return fail("not a percentage from {} to {}", kMinPlpRays, kMaxPlpRays);
    settings.plpRays = *percent;
    return {};
}

constexpr double kMinMaxFps = 0.1, kMaxMaxFps = 1000;

Result<void> parseMaxFps(Settings& settings, const std::string& text) {
    const auto fps = wholeNumber<double>(text);
    if (!fps || !(*fps == 0 || (*fps >= kMinMaxFps && *fps <= kMaxMaxFps)))
        return fail("not a number from {} to {}, nor 0", kMinMaxFps, kMaxMaxFps);
    settings.maxFps = *fps;
    return {};
}

constexpr double kMaxPreviewFps = 60;

Result<void> parsePreviewFps(Settings& settings, const std::string& text) {
    const auto fps = wholeNumber<double>(text);
    if (!fps || !(*fps >= 0 && *fps <= kMaxPreviewFps))
        return fail("not a number from 0 to {}", kMaxPreviewFps);
    settings.previewFps = *fps;
    return {};
}

constexpr std::uint32_t kMinPreviewSize = 16, kMaxPreviewSize = 4096;

Result<void> parsePreviewSize(Settings& settings, const std::string& text) {
    const auto size = wholeNumber<std::uint32_t>(text);
    if (!size || *size < kMinPreviewSize || *size > kMaxPreviewSize)
        return fail("not a number of pixels from {} to {}", kMinPreviewSize, kMaxPreviewSize);
    settings.previewSize = *size;
    return {};
}

constexpr std::uint64_t kMinPreviewRate = 1u << 10;

Result<void> parsePreviewRate(Settings& settings, const std::string& text) {
    ASSIGN_OR_RETURN(const std::uint64_t bytes, parseBytes(text));
    if (bytes < kMinPreviewRate) return fail("{} is less than 1k", text);
    settings.previewRate = bytes;
    return {};
}

constexpr std::array<const char*, 7> kShows{"none",     "ranges",   "levels",  "cache",
                                            "overdraw", "priority", "birdseye"};

Result<void> parseShow(Settings& settings, const std::string& text) {
    const auto found = std::find(kShows.begin(), kShows.end(), text);
    if (found == kShows.end())
        return fail("choose none, ranges, levels, cache, overdraw, priority or birdseye");
    settings.show = static_cast<Show>(found - kShows.begin());
    return {};
}

// Everything there is to know about a setting; a new one is one more row here.
struct Row {
    SettingInfo info;
    Result<void> (*parse)(Settings&, const std::string&);
    std::string (*print)(const Settings&);
};

constexpr std::size_t kRows = 16;
const std::array<Row, kRows>& rows() {
    static const std::array<Row, kRows> table{{
        {{"cache", "BYTES",
          "memory of one server for pages, as in 512M or 2G, default 1G; more means fewer reads from disk, "
          "and "
          "less memory for everything else on the machine",
          false},
         parseCache,
         [](const Settings& s) { return exactBytes(s.cacheBytes); }},
        {{"fetch-threads", "N",
          "threads of one server that read pages, 1 to 64, default 2; more hides a slow disk better and "
          "takes "
          "processor time from drawing",
          false},
         parseFetchThreads,
         [](const Settings& s) { return fmt::format("{}", s.fetchThreads); }},
        {{"shading", "flat|smooth|auto",
          "normals of each triangle or of the input, default auto: smooth where the input has normals"},
         parseShading,
         [](const Settings& s) { return shadingText(s.shading); }},
        {{"ramp", "height|none|auto",
          "colour by height or the input's own colours, default auto: by height where the input has none"},
         parseRamp,
         [](const Settings& s) { return rampText(s.ramp); }},
        {{"background", "RRGGBB", "colour where there is no surface, sRGB in hexadecimal, default 20242a"},
         parseBackground,
         [](const Settings& s) { return fmt::format("#{:06x}", s.background); }},
        {{"near", "DISTANCE",
          "distance of the near plane in model units, default 0: chosen from the model's size; larger cuts "
          "away more of what is close"},
         parseNear,
         [](const Settings& s) { return fmt::format("{}", s.near); }},
        {{"level", "L|full",
          "draw all of the model at level of detail L, from 0, the coarsest, on, default full: the input's "
          "own "
          "resolution, as with any L finer than what the dataset has; each level halves the error and draws "
          "more "
          "triangles"},
         parseLevel,
         [](const Settings& s) { return levelText(s.level); }},
        {{"mode", "frustum|plp|cplp",
          "what is drawn, default cplp: what is not hidden, to the same picture as frustum, which draws "
          "everything in "
          "view; plp: what probably shows most, not more than plp-budget; faster, but parts that can be seen "
          "may be "
          "missing"},
         parseMode,
         [](const Settings& s) { return modeText(s.mode); }},
        {{"occlusion", "hzb|queries",
          "how cplp finds what is hidden, default hzb: a pyramid of the depth, on the processor; queries: "
          "the GL's "
          "occlusion queries"},
         parseOcclusion,
         [](const Settings& s) { return occlusionText(s.occlusion); }},
        {{"plp-budget", "TRIANGLES",
          "with mode plp: the most triangles that a tile draws in a frame, 1000 or more, default 280000; "
          "more makes fewer pixels wrong and takes longer; pages of six times as many are read"},
         parsePlpBudget,
         [](const Settings& s) { return fmt::format("{}", s.plpBudget); }},
        {{"plp-rays", "PERCENT",
          "with mode plp: rays that look for what shows, in percent of the tile's pixels, 0.001 to 10, "
          "default 0.3; more chooses a little better and takes longer"},
         parsePlpRays,
         [](const Settings& s) { return fmt::format("{}", s.plpRays); }},
        {{"show", "none|ranges|levels|cache|overdraw|priority|birdseye",
          "what colours mean, default none, the model's own: ranges, each another; levels, from blue (0) to "
          "red, full "
          "grey; cache, green what was in memory and red what this frame read; overdraw, how many triangles "
          "cover the pixel: 1 blue, 4 teal, 16 green, 64 yellow, 256 white; priority, with mode plp, from "
          "red, chosen first, to blue; birdseye: from above, what is drawn for the tile, its frustum and the "
          "boxes of pages in view: green drawn, red read for this frame, blue left out"},
         parseShow,
         [](const Settings& s) { return std::string(kShows[static_cast<std::size_t>(s.show)]); }},
        {{"max-fps", "FPS",
          "frames that the wall draws in a second at most, 0.1 to 1000, default 0: no limit; one that the "
          "wall keeps makes frames steady and leaves time for other programs"},
         parseMaxFps,
         [](const Settings& s) { return fmt::format("{}", s.maxFps); }},
        {{"preview-fps", "FPS",
          "small pictures of the wall that clients get in a second, 0 to 60, default 5; 0: none; more "
          "follows "
          "the flight better and takes time from drawing"},
         parsePreviewFps,
         [](const Settings& s) { return fmt::format("{}", s.previewFps); }},
        {{"preview-size", "PX",
          "longer side of these pictures stitched together, 16 to 4096, default 640; more is clearer and "
          "larger"},
         parsePreviewSize,
         [](const Settings& s) { return fmt::format("{}", s.previewSize); }},
        {{"preview-rate", "BYTES",
          "bytes of them in a second for each client, 1k or more, default 1M; when that does not suffice "
          "they come less often"},
         parsePreviewRate,
         [](const Settings& s) { return exactBytes(s.previewRate); }},
    }};
    return table;
}

const Row* findRow(std::string_view name) {
    const auto found =
        std::find_if(rows().begin(), rows().end(), [&](const Row& row) { return row.info.name == name; });
    return found == rows().end() ? nullptr : &*found;
}

std::string allNames() {
    std::string names;
    for (const Row& row : rows()) names += (names.empty() ? "" : ", ") + std::string(row.info.name);
    return names;
}

}  // namespace

std::span<const SettingInfo> settingTable() {
    static const auto infos = [] {
        std::array<SettingInfo, kRows> all{};
        std::transform(rows().begin(), rows().end(), all.begin(), [](const Row& row) { return row.info; });
        return all;
    }();
    return infos;
}

Result<void> setSetting(Settings& settings, const std::string& name, const std::string& text) {
    const Row* row = findRow(name);
    if (!row) return fail("there is no setting '{}'; the settings are {}", name, allNames());
    const Result<void> parsed = row->parse(settings, text);
    if (!parsed) return fail("{} = '{}': {}", name, text, parsed.error().message);
    return {};
}

Result<void> changeSetting(Settings& settings, const std::string& name, const std::string& text) {
    Settings changed = settings;
    RETURN_IF_ERROR(setSetting(changed, name, text));
    if (!findRow(name)->info.live && changed != settings)
        return fail("{} cannot change while the servers run: start them with --{} {}", name, name, text);
    RETURN_IF_ERROR(checkSettings(changed));
    settings = changed;
    return {};
}

Result<void> checkSettings(const Settings& settings) {
    if (settings.show == Show::priority && settings.mode != Mode::plp)
        return fail("show = priority needs mode = plp: the other modes have no priorities");
    return {};
}

std::string settingText(const Settings& settings, const std::string& name) {
    const Row* row = findRow(name);
    CHECK(row != nullptr);
    return row->print(settings);
}

Result<std::uint64_t> parseBytes(const std::string& text) {
    std::string_view digits = text;
    int shift = 0;
    for (const ByteUnit& unit : kByteUnits) {
        if (digits.ends_with(unit.letter) || (unit.letter == 'k' && digits.ends_with('K')))
            shift = unit.shift;
    }
    if (shift != 0) digits.remove_suffix(1);

    const auto count = wholeNumber<std::uint64_t>(digits);
    if (!count) return fail("'{}' is not a number of bytes; write it as 1048576, 64k, 512M or 2G", text);
    if (*count > std::numeric_limits<std::uint64_t>::max() >> shift)
        return fail("'{}' is too many bytes", text);
    return *count << shift;
}

std::string formatBytes(std::uint64_t bytes) {
    if (bytes < 1024) return fmt::format("{} B", bytes);
    double value = static_cast<double>(bytes);
    std::size_t unit = 0;
    constexpr std::array<const char*, 7> kNames{"B", "KB", "MB", "GB", "TB", "PB", "EB"};
    for (; value >= 1024; ++unit) value /= 1024;
    // 1023.97 would print as 1024 of the smaller unit.
    if (value >= 1023.5) value /= 1024, ++unit;
    std::string number = fmt::format("{:.{}f}", value, value < 99.95 ? 1 : 0);
    if (number.ends_with(".0")) number.resize(number.size() - 2);
    return fmt::format("{} {}", number, kNames[unit]);
}

}  // namespace iwalk
