#include "server/gateway/frame_pace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace iwalk {

void FramePace::frameOver(Time now, double fps) {
    due_ = now;
    if (!(fps > 0)) return;
    const std::chrono::nanoseconds period(std::llround(1e9 / fps));
    const std::int64_t periods = (now - begun_ + period - std::chrono::nanoseconds(1)) / period;
    due_ = begun_ + std::max<std::int64_t>(1, periods) * period;
}

}  // namespace iwalk
