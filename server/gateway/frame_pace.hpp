#pragma once

#include <chrono>

namespace iwalk {

// When the next frame may begin, so that there are not more of them in a second than asked for: at a whole
// number of periods after the one before, on a steady clock, so that what a frame took does not add up. After
// a rest, when nothing was there to be drawn at that time, whatever comes begins at once.
class FramePace {
  public:
    using Time = std::chrono::steady_clock::time_point;

    // A frame is over. `fps` is the limit, frames in a second; 0: none, the next one may begin at once.
    void frameOver(Time now, double fps);
    Time due() const { return due_; }
    // What `ask` has for the next frame, if anything. It is asked only when a frame may begin: so what it has
    // is the newest there is, and waiting for the time does not make it older.
    template <class Ask>
    auto begin(Time now, Ask ask) -> decltype(ask()) {
        if (now < due_) return {};
        auto request = ask();
        if (request) begun_ = rests_ ? now : due_;
        rests_ = !request;
        return request;
    }

  private:
    Time begun_{}, due_{};
    bool rests_ = true;  // nothing was there when it was due
};

}  // namespace iwalk
