#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client/fly/frame_meter.hpp"
#include "client/options.hpp"
#include "common/protocol.hpp"

namespace iwalk::client {

class ServerLink;

// What is known of the wall at a moment.
struct WallState {
    std::shared_ptr<const protocol::Welcome> welcome;  // of the last connection; null before the first
    bool connected = false;
    bool told = false;  // whether this client controls; until then nothing is known of the camera either
    bool control = false;
    std::uint32_t waiting = 0;  // clients that wait to take over
    std::string trouble;        // why there is no connection; empty: there is one
    std::vector<protocol::NamedValue> settings;
    std::string refusal;                               // of the last change; empty: none
    std::shared_ptr<const protocol::FrameDone> frame;  // the newest
    double framesPerSecond = 0;                        // as FrameMeter has them
    FrameMeter::Spread latency, interval;
};

// The client's side of a wall for as long as the window is open. A thread of its own connects, and connects
// again when the servers are gone; then they get the camera and the settings that were asked for.
class Session {
  public:
    // `hello`: what is wanted from the beginning. `news` is called on the session's thread when state()
    // or previews() have something new.
    Session(const Address& server, const protocol::Hello& hello, std::function<void()> news);
    ~Session();  // may take as long as an attempt to connect, a second

    WallState state() const;
    // The newest small picture of the wall, all of its tiles, if there is one since the last call.
    std::vector<protocol::TileImage> previews();

    // Without control these wait for it. The newest camera wins.
    void setCamera(const Camera& camera);
    void changeSetting(const std::string& name, const std::string& value);

    void wishControl(bool control);
    void wishPreview(bool preview);

  private:
    using Clock = std::chrono::steady_clock;
    void run();
    Result<void> serve(ServerLink& link);
    std::vector<protocol::Message> due();
    Result<void> take(protocol::Message message);
    Result<void> takeFrame(protocol::FrameDone frame);
    Result<void> takePicture(protocol::TileImage image);
    void takeSettings(protocol::SettingsNow now);
    void wake();

    const Address server_;
    const std::function<void()> news_;

    mutable std::mutex mutex_;  // guards all below
    ServerLink* link_ = nullptr;
    bool stop_ = false;
    WallState state_;
    FrameMeter meter_;
    protocol::Hello hello_;
    bool helloDue_ = false;
    std::optional<Camera> camera_;  // that the wall is to show
    bool cameraDue_ = false;
    Clock::time_point cameraSince_;                // when it was asked for, or could be
    std::map<std::string, std::string> settings_;  // that were changed here
    bool settingsDue_ = false;
    std::uint64_t sequence_ = 0;
    std::map<std::uint32_t, protocol::TileImage> coming_;  // by tile: a picture of which some tiles are here
    std::vector<protocol::TileImage> previews_;            // a whole one

    std::thread thread_;
};

}  // namespace iwalk::client
