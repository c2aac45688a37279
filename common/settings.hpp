#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "common/dataset/hierarchy.hpp"
#include "common/result.hpp"

namespace iwalk {

enum class Shading : std::uint8_t { automatic, flat, smooth };
enum class Ramp : std::uint8_t { automatic, none, height };
enum class Mode : std::uint8_t { frustum, plp, cplp };
enum class Show : std::uint8_t { none, ranges, levels, cache, overdraw, priority, birdseye };
enum class OcclusionTest : std::uint8_t { hzb, queries };

// Every run-time setting of a server, the same on every tile. The command line, the [settings] table of a
// wall file and the report name them alike, through the table below.
struct Settings {
    std::uint64_t cacheBytes = std::uint64_t{1} << 30;
    std::uint32_t fetchThreads = 2;
    Shading shading = Shading::automatic;
    Ramp ramp = Ramp::automatic;
    std::uint32_t background = 0x20242a;  // 0xRRGGBB, sRGB
    double near = 0;                      // model units; 0: chosen from the model's size
    std::uint8_t level = kFullLevel;      // that all of the model is drawn at
    Mode mode = Mode::cplp;
    OcclusionTest occlusion = OcclusionTest::hzb;  // of Mode::cplp
    std::uint64_t plpBudget = 280000;              // of Mode::plp: triangles of a tile
    double plpRays = 0.3;                          // percent of the tile's pixels
    Show show = Show::none;
    double maxFps = 0;                     // 0: no limit
    double previewFps = 5;                 // 0: no previews
    std::uint32_t previewSize = 640;       // px: the wall's longer side
    std::uint64_t previewRate = 1u << 20;  // bytes a second to each client
    bool operator==(const Settings&) const = default;
};

// One row of the table: how people write a setting.
struct SettingInfo {
    const char* name;  // as in --name and in TOML
    const char* form;  // what a value looks like, with its unit: "BYTES", "flat|smooth|auto"
    const char* help;  // one line: what it does, its default, what gets better and worse when it is raised
    bool live = true;  // can be changed while the servers run; else only when they start
};
std::span<const SettingInfo> settingTable();

// Parses `text` ("512M", "flat", "#203040") into the setting `name`; an error says what would be right.
Result<void> setSetting(Settings& settings, const std::string& name, const std::string& text);
// Whether the settings go together.
Result<void> checkSettings(const Settings& settings);
// As setSetting, while servers run: refuses a setting that is not live, unless it has this value already, and
// what does not go together.
Result<void> changeSetting(Settings& settings, const std::string& name, const std::string& text);
// The value of the setting as setSetting takes it.
std::string settingText(const Settings& settings, const std::string& name);

// "512M", "2G", "1048576", "64k": bytes, with binary factors.
Result<std::uint64_t> parseBytes(const std::string& text);
// For people: "1.5 GB"-like with binary factors, at most four digits.
std::string formatBytes(std::uint64_t bytes);

}  // namespace iwalk
