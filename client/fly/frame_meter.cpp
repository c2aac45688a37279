#include "client/fly/frame_meter.hpp"

#include <algorithm>

namespace iwalk::client {
namespace {

constexpr std::chrono::seconds kSecond{1};
constexpr std::chrono::milliseconds kRest{50};  // without a camera: the flight has paused

double ms(FrameMeter::Time::duration duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

void FrameMeter::sent(std::uint64_t sequence, Time when) {
    waiting_.emplace_back(sequence, when);
}

void FrameMeter::done(const protocol::FrameDone& frame, Time when) {
    // Cameras that were overtaken are answered by the one that overtook them.
    while (!waiting_.empty() && frame.sequence != 0 && waiting_.front().first <= frame.sequence) {
        const auto [sequence, since] = waiting_.front();
        waiting_.pop_front();
        if (sequence != frame.sequence) continue;
        keep(latencies_, std::max(0.0, ms(when - since) - frame.sinceSwapMs));
        // After a rest the interval is the rest's.
        if (!swaps_.empty() && since < swaps_.back() + kRest) keep(intervals_, frame.timeMs);
    }
    swaps_.push_back(when);
    while (swaps_.front() + kSecond < when) swaps_.pop_front();
}

double FrameMeter::framesPerSecond(Time now) const {
    return static_cast<double>(
        std::count_if(swaps_.begin(), swaps_.end(), [&](Time swap) { return swap + kSecond > now; }));
}

FrameMeter::Spread FrameMeter::spread(std::deque<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    return {values[values.size() / 2], values[values.size() * 99 / 100]};
}

void FrameMeter::keep(std::deque<double>& values, double value) {
    values.push_back(value);
    if (values.size() > kFrames) values.pop_front();
}

}  // namespace iwalk::client
