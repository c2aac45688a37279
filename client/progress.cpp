#include "client/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace iwalk::client {
namespace {

constexpr std::chrono::milliseconds kInterval{100};  // between two drawings

void put(const std::string& text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace

TerminalProgress::TerminalProgress() : terminal_(::isatty(STDERR_FILENO) == 1) {}

TerminalProgress::~TerminalProgress() {
    if (terminal_) put("\r\033[K");
}

void TerminalProgress::show(std::size_t played, std::size_t total) {
    const Clock::time_point now = Clock::now();
    if (!terminal_ || played == 0 || now - shown_ < kInterval) return;
    shown_ = now;
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const double rate = static_cast<double>(played) / seconds;
    const auto left = static_cast<long>(static_cast<double>(total - played) / rate);
    put(fmt::format("\rframe {} of {}, {:.1f} a second, {}:{:02} left\033[K", played, total, rate, left / 60,
                    left % 60));
}

}  // namespace iwalk::client
