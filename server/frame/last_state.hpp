#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "common/camera_path.hpp"

namespace iwalk {

// The camera that the wall shows, kept in a file (a camera path of one frame), so that servers that are
// started again can go on with it. Writing waits until the camera rests for kRest, or for kLongest while it
// moves.
class LastCamera {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds kRest{200}, kLongest{2000};

    // Empty: nothing is kept.
    explicit LastCamera(std::string file) : file_(std::move(file)) {}

    // What was kept; nothing when there is no file, or it is none of ours.
    std::optional<Camera> load() const;
    // The wall shows it now.
    void shows(const Camera& camera, Clock::time_point now);
    // Writes when it is time to. To be called often. A file that cannot be written is said once.
    void keep(Clock::time_point now);

  private:
    const std::string file_;
    std::optional<Camera> unsaved_;
    Clock::time_point changed_, firstUnsaved_;
    bool reported_ = false;
};

}  // namespace iwalk
