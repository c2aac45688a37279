#include "client/fly/saved_views.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

namespace iwalk::client {

Result<SavedViews> SavedViews::open(const std::string& file) {
    SavedViews views;
    views.file_ = file;
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return views;
    ASSIGN_OR_RETURN(const std::vector<Camera> frames, loadCameraPath(file));
    // Saving a view would cut a flight short.
    if (frames.size() > kViews)
        return fail("{}: a path of {} frames, not {} saved views: choose another file with --views", file,
                    frames.size(), kViews);
    std::copy(frames.begin(), frames.end(), views.views_.begin());
    return views;
}

Result<void> SavedViews::save(std::size_t number, const Camera& view, const Camera& home) {
    views_.at(number) = view;
    std::vector<Camera> frames;
    for (const std::optional<Camera>& each : views_) {
        frames.push_back(each.value_or(home));
        frames.back().fovY = home.fovY;
    }
    return saveCameraPath(file_, frames);
}

}  // namespace iwalk::client
