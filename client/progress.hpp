#pragma once

#include <chrono>
#include <cstddef>

namespace iwalk::client {

// A line on the terminal with frames, rate and time left, drawn over itself on standard error; where that is
// no terminal, nothing.
class TerminalProgress {
  public:
    TerminalProgress();
    ~TerminalProgress();  // wipes the line
    void show(std::size_t played, std::size_t total);

  private:
    using Clock = std::chrono::steady_clock;
    const bool terminal_;
    const Clock::time_point start_ = Clock::now();
    Clock::time_point shown_{};
};

}  // namespace iwalk::client
