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
    static constexpr std::size_t kFrames = 200;  // that medians and 99th percentiles are over

    // `when`: the hands made it.
    void sent(std::uint64_t sequence, Time when);
    void done(const protocol::FrameDone& frame, Time when);
    // A new connection: what was sent is not answered any more.
    void forget() { waiting_.clear(); }

    double framesPerSecond(Time now) const;  // of the last second
    struct Spread {
        double median = 0, p99 = 0;  // ms; 0: not known yet
    };
    // From the moment of a camera to the swap that shows it.
    Spread latency() const { return spread(latencies_); }
    // From swap to swap in flight, as the wall measures it.
    Spread interval() const { return spread(intervals_); }
    std::size_t unanswered() const { return waiting_.size(); }

  private:
    static Spread spread(std::deque<double> values);
    static void keep(std::deque<double>& values, double value);

    std::deque<std::pair<std::uint64_t, Time>> waiting_;  // sequence numbers grow
    std::deque<Time> swaps_;                              // of the last second and a bit
    std::deque<double> latencies_, intervals_;
};

}  // namespace iwalk::client
