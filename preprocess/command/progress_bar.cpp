#include "preprocess/command/progress_bar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace iwalk {
namespace {

constexpr std::chrono::milliseconds kRedraw{100};
constexpr std::size_t kBarWidth = 30;

double secondsSince(std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

}  // namespace

ProgressBar::ProgressBar() : terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
    endPhase();
}

void ProgressBar::phase(const std::string& name) {
    endPhase();
    phase_ = name;
    began_ = Clock::now();
    drawn_ = {};
    if (terminal_) draw(0);
}

void ProgressBar::done(double part) {
    if (terminal_ && Clock::now() - drawn_ >= kRedraw) draw(std::clamp(part, 0.0, 1.0));
}

void ProgressBar::triangles(std::uint64_t count) {
    triangles_ = static_cast<double>(count);
}

void ProgressBar::note(const std::string& text) {
    if (terminal_) fmt::print(stderr, "\r\x1b[K");
    fmt::print(stderr, "note: {}\n", text);
}

void ProgressBar::draw(double part) {
    drawn_ = Clock::now();
    const double seconds = secondsSince(began_);
    const std::size_t full = static_cast<std::size_t>(part * static_cast<double>(kBarWidth));
    std::string line =
        fmt::format("\r{:<18} [{:<{}}] {:3.0f} %", phase_, std::string(full, '#'), kBarWidth, part * 100);
    if (part > 0.01 && seconds > 0.5) {
        line += triangles_ > 0 ? fmt::format("  {:.2f} Mtri/s", 1e-6 * part * triangles_ / seconds)
                               : fmt::format("  {:.1f} %/s", part * 100 / seconds);
        line += fmt::format("  ETA {:.0f} s", seconds * (1 - part) / part);
    }
    fmt::print(stderr, "{}\x1b[K", line);
    std::fflush(stderr);
}

void ProgressBar::endPhase() {
    if (phase_.empty()) return;
    if (terminal_) fmt::print(stderr, "\r\x1b[K");
    fmt::print(stderr, "{}: {:.1f} s\n", phase_, secondsSince(began_));
    phase_.clear();
}

}  // namespace iwalk
