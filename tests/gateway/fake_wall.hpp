#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "server/gateway/gateway.hpp"

namespace iwalk::testing {

// A server without MPI and GL: a real gateway, and a thread that "draws" what it asks for. Tile t of a frame
// is one colour, (eye.x, t, 200), with depth eye.x; a frame takes `frameTime` and says it took 10 ms + eye.x.
class FakeWall {
  public:
    struct Behaviour {
        std::uint64_t vanishAfter = ~std::uint64_t{0};  // frames; then the gateway is closed
        int extraWidth = 0;                             // px by which pictures are wider than their tiles
        std::chrono::milliseconds frameTime{0};
        std::function<void(protocol::TileImage&)> spoil = nullptr;  // changes pictures before they are sent
    };

    FakeWall() : FakeWall(Behaviour{}) {}
    explicit FakeWall(Behaviour behaviour, protocol::Welcome welcome = {}, std::uint16_t port = 0);
    ~FakeWall();

    std::uint16_t port() const { return port_; }
    std::vector<double> drawn() const;  // eye.x of every frame, in order
    std::vector<Mode> modes() const;    // and the setting `mode`

  private:
    void loop();
    void draw(const protocol::CameraRequest& request, Mode mode);
    void capture(const protocol::CameraRequest& request, std::uint32_t tile);

    const Behaviour behaviour_;
    protocol::Welcome welcome_;
    std::unique_ptr<Gateway> gateway_;
    std::uint16_t port_ = 0;
    std::atomic<bool> stop_{false};
    mutable std::mutex mutex_;
    std::vector<double> drawn_;  // guarded by mutex_, as is modes_
    std::vector<Mode> modes_;
    std::thread thread_;
};

}  // namespace iwalk::testing
