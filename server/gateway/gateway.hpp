#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/protocol.hpp"
#include "common/result.hpp"
#include "common/settings.hpp"

namespace iwalk {

// The one door of the wall: sockets in, camera requests out; finished frames and images in, messages out.
// Rank 0 owns one. It has a thread of its own for all sockets and knows nothing of MPI, GL or the dataset.
//
// One client controls, others watch: the first that asks for control has it, and when it is gone the one that
// has waited longest takes over. Bounded whatever clients send: at most kMaxClients connections,
// kMaxClientPayload bytes a message, kMaxQueuedRequests waiting requests, kMaxUnsentBytes of unsent messages
// a client (a client over that, one that says nothing useful within kHelloTimeout of connecting, or one that
// takes nothing of what waits for it for kStallTimeout, is dropped).
class Gateway {
  public:
    static constexpr int kMaxClients = 32;
    static constexpr int kMaxQueuedRequests = 64;
    static constexpr std::uint64_t kMaxUnsentBytes = std::uint64_t{1} << 30;
    static constexpr int kHelloTimeoutSeconds = 5;
    static constexpr int kStallTimeoutSeconds = 60;

    // The limits above, for tests to make smaller.
    struct Limits {
        std::size_t clients = kMaxClients;
        std::size_t queuedRequests = kMaxQueuedRequests;
        std::uint64_t unsentBytes = kMaxUnsentBytes;
        std::chrono::milliseconds helloTimeout = std::chrono::seconds(kHelloTimeoutSeconds);
        std::chrono::milliseconds stallTimeout = std::chrono::seconds(kStallTimeoutSeconds);
    };

    // Listens at `address` (a number or a name):`port` (port 0: any free one). Fails when the port is in use,
    // saying so. With a `token`, only clients that bring it are let in; without one it listens on the
    // loopback only.
    static Result<std::unique_ptr<Gateway>> listen(const std::string& address, std::uint16_t port,
                                                   const protocol::Welcome& welcome,
                                                   const std::string& token = {});
    static Result<std::unique_ptr<Gateway>> listen(const std::string& address, std::uint16_t port,
                                                   const protocol::Welcome& welcome, const Limits& limits,
                                                   const std::string& token = {});
    // Says good-bye to every client and closes everything; what is unsent has a quarter of a second to go
    // out.
    virtual ~Gateway() = default;

    virtual std::uint16_t port() const = 0;

    // What to draw next: the oldest request in lock step, else the newest camera if it has not been taken
    // yet, else nothing. A request that captures is held back while more than kMaxUnsentBytes / 4 are unsent
    // to its sender. Never blocks.
    virtual std::optional<protocol::CameraRequest> nextRequest() = 0;

    // The settings, when a client changed them since the last call. Whatever came before a request that
    // nextRequest() gave out is known by then. Never blocks.
    virtual std::optional<Settings> newSettings() = 0;

    struct PreviewWish {
        bool wanted = false;       // some client wants small pictures of the wall
        std::uint64_t joined = 0;  // grows when one more does
    };
    virtual PreviewWish previewWish() const = 0;

    // Tells every client that a frame is on the wall. `frame.sequence` is the number of the request that
    // nextRequest() gave out, 0 for a frame that nobody asked for; the last 4096 numbers are remembered. From
    // any thread.
    virtual void frameDone(protocol::FrameDone frame) = 0;
    // Sends a captured tile to the client whose request `image.sequence` was, if it is still there. Sequence
    // numbers are the gateway's own between nextRequest() and here (clients' numbers may collide), and are
    // translated back. A preview goes to every client that wants some and has taken what it was sent before;
    // for others it is dropped. From any thread.
    virtual void tileImage(protocol::TileImage image) = 0;
};

}  // namespace iwalk
