#pragma once

#include <cstddef>
#include <vector>

#include "common/camera_path.hpp"

namespace iwalk::client {

// A flight as a camera path: so many frames a second of those times in which the camera moves.
class Recorder {
  public:
    static constexpr double kFps = 30;
    static constexpr std::size_t kMostFrames = 1'000'000;  // nine hours

    // The camera at a time (seconds, growing). Nothing when it was the last frame's already, or too soon.
    void add(double seconds, const Camera& camera);
    const std::vector<Camera>& path() const { return path_; }

  private:
    std::vector<Camera> path_;
    double due_ = 0;
};

// What a path shows `seconds` after its beginning; nullptr when it has ended.
const Camera* replayed(const std::vector<Camera>& path, double seconds);

}  // namespace iwalk::client
