#include "server/frame/last_state.hpp"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "common/file.hpp"

namespace iwalk {
namespace {

using nlohmann::json;

json vectorJson(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

// Throws json's exceptions.
glm::dvec3 vectorOf(const json& object, const char* key) {
    const auto v = object.at(key).get<std::array<double, 3>>();
    return {v[0], v[1], v[2]};
}
Camera cameraOf(const json& object) {
    return {vectorOf(object, "eye"), vectorOf(object, "target"), vectorOf(object, "up"),
            object.at("fov_y_deg").get<double>()};
}

bool live(std::string_view name) {
    for (const SettingInfo& setting : settingTable())
        if (name == setting.name) return setting.live;
    return true;  // setSetting() will say that there is no such setting
}

}  // namespace

Result<LastState::Known> LastState::read() const {
    if (!std::filesystem::is_regular_file(file_)) return fail("{}: not a file", file_);
    ASSIGN_OR_RETURN(const std::string text, readWholeFile(file_, kMaxBytes));
    Known known;
    known.settings = start_;
    try {
        const json document = json::parse(text);
        if (document.contains("camera")) {
            known.camera = cameraOf(document.at("camera"));
            const Result<void> checked = checkCamera(*known.camera);
            if (!checked) return fail("{}: {}", file_, checked.error().message);
        }
        for (const auto& [name, value] : document.at("settings").items()) {
            if (!live(name)) return fail("{}: {} cannot change while servers run", file_, name);
            const Result<void> set = setSetting(known.settings, name, value.get<std::string>());
            if (!set) return fail("{}: {}", file_, set.error().message);
        }
    } catch (const json::exception& error) {
        return fail("{}: {}", file_, error.what());
    }
    const Result<void> together = checkSettings(known.settings);
    if (!together) return fail("{}: {}", file_, together.error().message);
    return known;
}

LastState::Known LastState::load() {
    std::error_code error;
    if (file_.empty() || !std::filesystem::exists(file_, error)) return last_;
    Result<Known> known = read();
    if (!known) spdlog::error("{}; the wall begins without what was kept", known.error().message);
    if (known) last_ = std::move(*known);
    return last_;
}

void LastState::shows(const Camera& camera, Clock::time_point now) {
    if (last_.camera != camera) noteChange(now);
    last_.camera = camera;
}

void LastState::changes(const Settings& settings, Clock::time_point now) {
    if (last_.settings != settings) noteChange(now);
    last_.settings = settings;
}

void LastState::noteChange(Clock::time_point now) {
    if (!unsaved_) firstUnsaved_ = now;
    unsaved_ = kept();
    changed_ = now;
}

void LastState::keep(Clock::time_point now) {
    if (unsaved_ && (now - changed_ >= kRest || now - firstUnsaved_ >= kLongest)) write();
}

void LastState::write() {
    unsaved_ = false;
    json document = {{"settings", json::object()}};
    if (last_.camera)
        document["camera"] = {{"eye", vectorJson(last_.camera->eye)},
                              {"target", vectorJson(last_.camera->target)},
                              {"up", vectorJson(last_.camera->up)},
                              {"fov_y_deg", last_.camera->fovY}};
    for (const SettingInfo& setting : settingTable()) {
        const std::string value = settingText(last_.settings, setting.name);
        if (value != settingText(start_, setting.name)) document["settings"][setting.name] = value;
    }
    const Result<void> saved = replaceFile(file_, document.dump(1) + "\n");
    if (!saved && !std::exchange(reported_, true))
        spdlog::error("{}; what the wall shows is not kept", saved.error().message);
}

void LastState::beat(Clock::time_point now) {
    nextBeat_ = now + kBeat;
    if (::utimensat(AT_FDCWD, file_.c_str(), nullptr, 0) != 0) write();
}

}  // namespace iwalk
