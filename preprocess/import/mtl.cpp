#include "preprocess/import/mtl.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "preprocess/import/line_reader.hpp"
#include "preprocess/import/number.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

// Far more than any model has; they bound what a hostile file can make us keep (about 16 MiB).
constexpr std::size_t kMaxLibraries = 256, kMaxMaterials = 65536, kMaxName = 128;

// Where the library is; none when that would be outside the OBJ's folder.
std::optional<std::filesystem::path> inFolder(const std::string& objPath, std::string_view name) {
    std::string unixName(name);
    std::ranges::replace(unixName, '\\', '/');
    const bool drive = unixName.size() > 1 && unixName[1] == ':';
    const std::filesystem::path relative(unixName);
    if (drive || relative.is_absolute() || std::ranges::find(relative, "..") != relative.end()) return {};
    return std::filesystem::path(objPath).parent_path() / relative;
}

bool isFile(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
}

std::uint32_t colorOf(const std::array<double, 3>& kd) {
    std::array<std::uint8_t, 4> rgba{0, 0, 0, 255};
    for (std::size_t i = 0; i < 3; ++i) {
        rgba[i] =
            kd[i] > 0 ? static_cast<std::uint8_t>(std::lround(std::min(kd[i], 1.0) * 255)) : std::uint8_t{0};
    }
    std::uint32_t color = 0;
    std::memcpy(&color, rgba.data(), sizeof color);
    return color;
}

// One number stands for all three. None for the spectral and xyz forms, which give no colour to show.
std::optional<std::uint32_t> parseKd(std::string_view text) {
    std::array<double, 3> kd{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string_view word = takeWord(text);
        if (word.empty() && i == 1) {
            kd[1] = kd[2] = kd[0];
            break;
        }
        if (word.empty() || parseNumber(word.data(), kd[i]) != word.data() + word.size()) return {};
    }
    return colorOf(kd);
}

}  // namespace

void Materials::load(const std::string& objPath, std::string_view names) {
    // A name may hold blanks, and there may be several names: the file system tells which it is.
    names = trim(names);
    const auto whole = inFolder(objPath, names);
    const bool one = whole && isFile(*whole);
    while (!names.empty()) {
        const std::string_view name = one ? std::exchange(names, {}) : takeWord(names);
        if (opened_.size() == kMaxLibraries || !opened_.insert(std::string(name)).second) continue;
        const auto path = inFolder(objPath, name);
        if (!path) {
            spdlog::warn("{}: material library {} lies outside the model's folder: not read", objPath,
                         quote(name));
            continue;
        }
        if (!isFile(*path)) {
            spdlog::warn("{}: there is no material library {}: its materials are grey", objPath, quote(name));
            continue;
        }
        if (const auto loaded = loadFile(path->string()); !loaded) {
            spdlog::warn("{}: colours are missing: {}", objPath, loaded.error().message);
        }
    }
}

Result<void> Materials::loadFile(const std::string& path) {
    ASSIGN_OR_RETURN(const auto file, openForReading(path));
    LineReader lines(*file, path);
    std::string name;
    for (std::string_view line;;) {
        ASSIGN_OR_RETURN(const bool more, lines.next(line));
        if (!more) return {};
        const std::string_view keyword = takeWord(line);
        if (keyword == "newmtl") name = trim(line);
        if (keyword != "Kd" || name.size() > kMaxName) continue;
        const auto color = parseKd(line);
        if (!color) continue;
        if (colors_.size() == kMaxMaterials)
            return lines.bad(fmt::format("more than {} materials", kMaxMaterials));
        colors_[name] = *color;
    }
}

std::uint32_t Materials::color(std::string_view name) const {
    if (name.size() > kMaxName) return kGrey;
    const auto found = colors_.find(std::string(name));
    return found == colors_.end() ? kGrey : found->second;
}

}  // namespace iwalk
