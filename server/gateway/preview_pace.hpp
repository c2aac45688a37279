#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace iwalk {

// When small pictures of the wall are made for clients: so many times a second at most, so many bytes a
// second at most, only when there is something new to see, and never before the last ones are all on rank 0.
// What would come too early is left out, not queued.
class PreviewPace {
  public:
    using Time = std::chrono::steady_clock::time_point;

    // The wall shows another frame, or someone new looks.
    void somethingNew() { stale_ = true; }
    // `fps` may be 0: never.
    bool due(Time now, double fps) const { return stale_ && fps > 0 && awaited_ == 0 && now >= next_; }
    // Each of so many tiles makes a picture now.
    void begin(Time now, std::size_t tiles);
    // One of them is here. `fps` > 0 and `bytesPerSecond` > 0 say when the next ones are due.
    void arrived(std::size_t bytes, double fps, std::uint64_t bytesPerSecond);

  private:
    bool stale_ = false;
    std::size_t awaited_ = 0;  // tiles
    std::uint64_t bytes_ = 0;  // of those that are here
    Time begun_{}, next_{};
};

}  // namespace iwalk
