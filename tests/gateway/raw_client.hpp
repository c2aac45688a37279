#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "common/protocol.hpp"

namespace iwalk::testing {

// A client that does exactly what a test says, over a blocking socket to 127.0.0.1.
class RawClient {
  public:
    explicit RawClient(std::uint16_t port);
    ~RawClient() { close(); }
    RawClient(RawClient&& other) noexcept;
    RawClient(const RawClient&) = delete;

    void close();
    // False when the server has closed.
    bool sendBytes(std::span<const std::byte> bytes);
    bool send(const protocol::Message& message) { return sendBytes(protocol::encode(message)); }
    // The next message; nothing when the connection ended, or (a failed test) nothing came for 30 seconds.
    std::optional<protocol::Message> receive();
    // The next message of this type; others are skipped.
    template <class T>
    std::optional<T> receiveA() {
        while (auto message = receive()) {
            if (const T* wanted = std::get_if<T>(&*message)) return *wanted;
        }
        return std::nullopt;
    }
    // Greets; whether control was granted.
    bool greet(bool control = true);
    // Sends a camera whose eye is (sequence, 0, 0).
    bool sendCamera(std::uint64_t sequence, std::uint8_t flags);
    // Reads until the end of the connection.
    bool isDropped() { return !receiveA<protocol::Hello>(); }

  private:
    bool readBytes(std::span<std::byte> out);
    int socket_ = -1;
};

// Looks again and again whether `condition` has come true; false after half a minute, for a test that is to
// fail.
template <class Condition>
bool eventually(Condition condition) {
    for (int i = 0; i < 3000; ++i) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}

// Two tiles of 16 x 8 px, "left" and "right", with a bezel of 4 px between them.
protocol::Welcome smallWall();

}  // namespace iwalk::testing
