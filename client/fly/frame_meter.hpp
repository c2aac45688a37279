#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <utility>

#include "common/protocol.hpp"

namespace iwalk::client {

// How the wall keeps up, from what is sent and what comes back. Times are given, not taken: no clock inside.
class FrameMeter {
  public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr std::size_t kFrames = 60;  // that medians are over

    void sent(std::uint64_t sequence, Time when);
    void done(const protocol::FrameDone& frame, Time when);
    // A new connection: what was sent is not answered any more.
    void forget() { waiting_.clear(); }

    double framesPerSecond(Time now) const;  // of the last second
    // From sending a camera to hearing that it is on the wall, ms: median; 0: not known yet.
    double latencyMs() const { return median(latencies_); }
    // From swap to swap, ms, in flight: median; 0: not known yet.
    double intervalMs() const { return median(intervals_); }
    std::size_t unanswered() const { return waiting_.size(); }

  private:
    static double median(std::deque<double> values);
    static void keep(std::deque<double>& values, double value);

    std::deque<std::pair<std::uint64_t, Time>> waiting_;  // sequence numbers grow
    std::deque<Time> swaps_;                              // of the last second and a bit
    std::deque<double> latencies_, intervals_;
};

}  // namespace iwalk::client
