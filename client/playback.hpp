#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "client/capture.hpp"
#include "client/options.hpp"
#include "client/report.hpp"
#include "client/server_link.hpp"
#include "common/camera_path.hpp"

namespace iwalk::client {

// Plays a camera path: cameras out in the path's order, frames and pictures in, and nothing that was not
// asked for.
class Playback {
  public:
    struct Options {
        Pace pace = Pace::lockstep;
        double fps = 30;            // frames of the path per second, > 0; realtime only
        bool captureDepth = false;  // with pictures, their depth
    };
    using Progress = std::function<void(std::size_t played, std::size_t total)>;

    // `link` and `capture` outlive this; `capture` is null when no pictures are wanted. `path` is not empty.
    Playback(ServerLink& link, std::vector<Camera> path, Capture* capture, const Options& options);

    // Waits to be given control of the wall.
    Result<void> awaitControl(ServerLink::Clock::time_point deadline);
    // Until the last frame is on the wall and its pictures are handed to the capture.
    Result<std::vector<PlayedFrame>> run(const Progress& progress);

  private:
    // A request under way; its key is its sequence number, which is the frame's index in the path plus 1.
    struct Request {
        ServerLink::Clock::time_point sent{};
        bool done = false;
        std::set<std::pair<std::uint32_t, protocol::ImageKind>> pictures;
    };

    Result<void> sendDue();
    Result<void> sendFrame(std::size_t frame);
    bool hasRoom() const;
    std::size_t framesDueNow() const;
    ServerLink::Clock::time_point nextLook() const;
    Result<void> take(const protocol::Message& message);
    Result<void> takeFrame(const protocol::FrameDone& done);
    Result<void> takeImage(const protocol::TileImage& image);
    Result<void> checkStats(const protocol::FrameDone& done) const;
    void settle(std::uint64_t sequence);
    std::size_t picturesPerFrame() const;

    ServerLink& link_;
    const std::vector<Camera> path_;
    Capture* const capture_;
    const Options options_;
    ServerLink::Clock::time_point start_{};
    std::size_t next_ = 0;  // index in the path of the next frame to send
    std::map<std::uint64_t, Request> underWay_;
    std::vector<PlayedFrame> played_;
};

}  // namespace iwalk::client
