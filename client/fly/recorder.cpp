#include "client/fly/recorder.hpp"

#include <algorithm>

namespace iwalk::client {

void Recorder::add(double seconds, const Camera& camera) {
    const bool first = path_.empty();
    if (path_.size() == kMostFrames || (!first && (seconds < due_ || camera == path_.back()))) return;
    path_.push_back(camera);
    // Frames that come a little late do not add up; a pause is left out.
    due_ = first ? seconds + 1 / kFps : std::max(due_, seconds - 1 / kFps) + 1 / kFps;
}

const Camera* replayed(const std::vector<Camera>& path, double seconds) {
    const double frame = seconds * Recorder::kFps;
    if (!(frame >= 0 && frame < static_cast<double>(path.size()))) return nullptr;
    return &path[static_cast<std::size_t>(frame)];
}

}  // namespace iwalk::client
