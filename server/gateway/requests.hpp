#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "common/protocol.hpp"
#include "common/settings.hpp"

namespace iwalk {

// What both threads know of a client. Outlives its connection for as long as requests of it are under way.
struct Sender {
    explicit Sender(std::uint64_t number) : id(number) {}
    const std::uint64_t id;
    std::atomic<std::uint64_t> unsentBytes{0};  // messages made for it and not yet taken by the network
    std::atomic<bool> gone{false};
};
using SenderPtr = std::shared_ptr<Sender>;

// The waiting camera requests, and who asked for the frames under way. The gateway's thread adds, the frame
// loop takes; one mutex, held for a few instructions. Gives requests numbers of its own: those of two clients
// may collide.
class Requests {
  public:
    struct Limits {
        std::size_t queued = 0;           // waiting requests in lock step
        std::uint64_t holdBackBytes = 0;  // no capture for a sender with more than this unsent
    };
    struct Origin {
        SenderPtr sender;
        std::uint64_t sequence = 0;  // the sender's own number
    };
    struct Taken {
        protocol::CameraRequest request;  // its sequence is ours
        bool madeRoom = false;            // the queue was full until now
    };
    static constexpr std::size_t kRemembered =
        4096;  // requests whose origin is known; far more than are drawn at once

    // Written by the gateway's thread, read by the frame loop.
    std::atomic<int> previewClients{0};
    std::atomic<std::uint64_t> previewsJoined{0};

    explicit Requests(const Limits& limits) : limits_(limits) {}

    // In lock step appends, otherwise replaces the newest camera. False when the queue is full now: add no
    // more until take() made room.
    bool add(const SenderPtr& sender, const protocol::CameraRequest& request);
    // Forgets what waits of a sender (that is gone or controls no more).
    void drop(const Sender& sender);
    // The oldest in lock step, else the newest camera, once; nothing when that one is held back.
    std::optional<Taken> take();
    // The settings from now on, and once to whom asks whether they changed.
    void changeSettings(const Settings& settings);
    std::optional<Settings> takeSettings();
    // Who asked for the request that take() gave the number `sequence`; nothing if forgotten.
    std::optional<Origin> origin(std::uint64_t sequence) const;

  private:
    struct Waiting {
        SenderPtr sender;
        protocol::CameraRequest request;
    };
    bool heldBack(const Waiting& waiting) const;
    bool full() const { return lockstep_.size() >= limits_.queued; }

    const Limits limits_;
    mutable std::mutex mutex_;  // guards all below
    std::deque<Waiting> lockstep_;
    std::optional<Waiting> newest_;
    std::optional<Settings> settings_;  // changed and not taken yet
    std::map<std::uint64_t, Origin> origins_;
    std::uint64_t lastNumber_ = 0;
};

}  // namespace iwalk
