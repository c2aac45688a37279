#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

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

// From window depths of some pixels: near plane (model units) / distance, 0 where there is no surface. Orders
// `depths` anew.
inline void addDepths(std::vector<float>& depths, double near, protocol::TileStats& stats) {
    std::erase(depths, 0.0f);
    if (depths.empty()) return;
    const auto farthestOf = [&](double share) {
        const auto place =
            depths.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(depths.size()));
        std::nth_element(depths.begin(), place, depths.end(), std::greater());
        return near / static_cast<double>(*place);
    };
    stats.nearDepth = farthestOf(0.05);
    stats.midDepth = farthestOf(0.5);
}

inline void addCounters(const PageCache::Counters& counters, protocol::TileStats& stats) {
    stats.fetchWaitMs += counters.waitMs;
    stats.fetchedBytes += counters.fetchedBytes;
    stats.stalls += counters.stalls;
    stats.badPages += counters.badPages;
}

}  // namespace iwalk
