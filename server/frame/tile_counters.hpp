#pragma once

#include <chrono>

#include "common/protocol.hpp"
#include "server/cache/page_cache.hpp"

namespace iwalk {

class Stopwatch {
  public:
    // Milliseconds since the last call, or since the beginning.
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
        last_ = now;
        return ms;
    }

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

inline void addCounters(const PageCache::Counters& counters, protocol::TileStats& stats) {
    stats.fetchWaitMs += counters.waitMs;
    stats.fetchedBytes += counters.fetchedBytes;
    stats.stalls += counters.stalls;
    stats.badPages += counters.badPages;
}

}  // namespace iwalk
