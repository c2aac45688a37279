#include "tests/gateway/fake_wall.hpp"

#include <gtest/gtest.h>

#include "common/image.hpp"
#include "tests/gateway/raw_client.hpp"

namespace iwalk::testing {

FakeWall::FakeWall(Behaviour behaviour, protocol::Welcome welcome, std::uint16_t port)
    : behaviour_(std::move(behaviour)), welcome_(welcome.tiles.empty() ? smallWall() : std::move(welcome)) {
    auto gateway = Gateway::listen("127.0.0.1", port, welcome_);
    EXPECT_TRUE(gateway.ok());
    gateway_ = std::move(gateway).value();
    port_ = gateway_->port();
    thread_ = std::thread([this] { loop(); });
}

FakeWall::~FakeWall() {
    stop_ = true;
    thread_.join();
}

std::vector<double> FakeWall::drawn() const {
    const std::lock_guard lock(mutex_);
    return drawn_;
}

std::vector<Mode> FakeWall::modes() const {
    const std::lock_guard lock(mutex_);
    return modes_;
}

void FakeWall::loop() {
    Settings settings;
    while (!stop_) {
        if (drawn().size() >= behaviour_.vanishAfter) return gateway_.reset();
        const auto request = gateway_->nextRequest();
        settings = gateway_->newSettings().value_or(settings);
        if (request) draw(*request, settings.mode);
        if (!request) std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
}

void FakeWall::draw(const protocol::CameraRequest& request, Mode mode) {
    std::this_thread::sleep_for(behaviour_.frameTime);
    std::size_t frame = 0;
    {
        const std::lock_guard lock(mutex_);
        drawn_.push_back(request.camera.eye.x);
        modes_.push_back(mode);
        frame = drawn_.size();
    }
    protocol::FrameDone done{request.sequence, frame, 10 + request.camera.eye.x, {}, request.camera};
    for (std::uint32_t tile = 0; tile < welcome_.tiles.size(); ++tile) {
        capture(request, tile);
        protocol::TileStats stats;
        stats.tile = tile;
        stats.drawMs = 2.5;
        stats.triangles = 1000 + tile;
        stats.nearDepth = 1 + tile;
        stats.midDepth = 4;
        stats.peakRssBytes = (frame == 2 ? 900u : 500u) + tile;
        done.tiles.push_back(stats);
    }
    gateway_->frameDone(done);
}

void FakeWall::capture(const protocol::CameraRequest& request, std::uint32_t tile) {
    const int width = welcome_.tiles[tile].width + behaviour_.extraWidth,
              height = welcome_.tiles[tile].height;
    const auto send = [&](protocol::ImageKind kind, std::vector<std::byte> bytes) {
        protocol::TileImage image{request.sequence, tile, kind, std::move(bytes)};
        if (behaviour_.spoil) behaviour_.spoil(image);
        gateway_->tileImage(std::move(image));
    };
    if (request.flags & protocol::kCaptureColor) {
        ColorImage color(width, height, 3);
        for (std::size_t i = 0; i < color.pixels.size(); i += 3) {
            color.pixels[i] = static_cast<std::uint8_t>(request.camera.eye.x);
            color.pixels[i + 1] = static_cast<std::uint8_t>(tile);
            color.pixels[i + 2] = 200;
        }
        send(protocol::ImageKind::png, encodePng(color).value());
    }
    if (request.flags & protocol::kCaptureDepth) {
        DepthImage depth(width, height, 1);
        std::fill(depth.pixels.begin(), depth.pixels.end(), static_cast<float>(request.camera.eye.x));
        send(protocol::ImageKind::exr, encodeExr(depth).value());
    }
}

}  // namespace iwalk::testing
