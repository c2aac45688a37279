#include "server/frame/last_camera.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <utility>

namespace iwalk {

std::optional<Camera> LastCamera::load() const {
    if (file_.empty() || !std::filesystem::exists(file_)) return {};
    const Result<std::vector<Camera>> path = loadCameraPath(file_);
    if (path.ok() && path->size() == 1) return path->front();
    spdlog::error("{}; the wall begins without a camera",
                  path.ok() ? fmt::format("{} has {} cameras instead of one", file_, path->size())
                            : path.error().message);
    return {};
}

void LastCamera::shows(const Camera& camera, Clock::time_point now) {
    if (file_.empty()) return;
    if (!unsaved_) firstUnsaved_ = now;
    unsaved_ = camera;
    changed_ = now;
}

void LastCamera::keep(Clock::time_point now) {
    if (!unsaved_ || (now - changed_ < kRest && now - firstUnsaved_ < kLongest)) return;
    const Result<void> saved = saveCameraPath(file_, {*std::exchange(unsaved_, {})});
    if (!saved && !std::exchange(reported_, true))
        spdlog::error("{}; the last camera is not kept", saved.error().message);
}

}  // namespace iwalk
