#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "common/camera_path.hpp"
#include "common/settings.hpp"

namespace iwalk {

// What the wall shows, kept in a file, so that servers that are started again can go on with it: the camera,
// and the settings that clients have changed. Writing waits until nothing has changed for kRest, or for
// kLongest while something does. The file's time is a sign of life, too.
class LastState {
  public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds kRest{200}, kLongest{2000};
    static constexpr std::chrono::seconds kBeat{1};
    static constexpr std::uint64_t kMaxBytes = 64u << 10;  // of the file

    struct Known {
        std::optional<Camera> camera;
        Settings settings;
    };

    // `start`: what the servers were started with. An empty `file`: nothing is kept.
    LastState(std::string file, const Settings& start) : file_(std::move(file)), start_(start) {
        last_.settings = start;
    }
    bool kept() const { return !file_.empty(); }
    // What was kept; when there is no file, or it is none of ours, no camera and the settings of the start.
    Known load();
    // The wall shows this now; a client has changed settings.
    void shows(const Camera& camera, Clock::time_point now);
    void changes(const Settings& settings, Clock::time_point now);
    // Writes when it is time to. To be called often. A file that cannot be written is said once.
    void keep(Clock::time_point now);

    // Whether it is time to say that the wall lives, and that it does: the file gets the present time, and is
    // made if there is none.
    bool beatDue(Clock::time_point now) const { return kept() && now >= nextBeat_; }
    void beat(Clock::time_point now);

  private:
    Result<Known> read() const;
    void noteChange(Clock::time_point now);
    void write();

    const std::string file_;
    const Settings start_;
    Known last_;
    bool unsaved_ = false, reported_ = false;
    Clock::time_point changed_, firstUnsaved_, nextBeat_{};
};

}  // namespace iwalk
