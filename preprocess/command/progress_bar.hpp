#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "preprocess/build/build.hpp"

namespace iwalk {

// Progress for people, on standard error: a bar with rate and time left on a terminal, else one line for each
// phase when it is over.
class ProgressBar : public Progress {
  public:
    ProgressBar();
    ~ProgressBar() override;  // ends the last phase
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    void phase(const std::string& name) override;
    void done(double part) override;
    void triangles(std::uint64_t count) override;
    void note(const std::string& text) override;

  private:
    using Clock = std::chrono::steady_clock;
    void endPhase();
    void draw(double part);

    bool terminal_;
    double triangles_ = 0;  // 0: not known yet
    std::string phase_;
    Clock::time_point began_, drawn_;
};

}  // namespace iwalk
