#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol.hpp"

namespace iwalk::client {

struct PlayedFrame {
    std::size_t frame = 0;  // index in the path
    protocol::FrameDone done;
    double latencyMs = 0;  // from sending the camera to the swap that shows it
};

// ms. Quantiles are interpolated linearly between the closest two values.
struct FrameTimes {
    double median = 0, p01 = 0, p99 = 0;
};
// Of the intervals from swap to swap. Leaves out the first frame: the interval before it is not of this path.
// Nothing when no frame is left.
std::optional<FrameTimes> frameTimes(const std::vector<PlayedFrame>& frames);
// From sending a camera to the swap that shows it. `frames` is not empty.
FrameTimes latencies(const std::vector<PlayedFrame>& frames);

// The JSON text of --report (docs/protocol.md, "The client's report").
std::string reportText(const protocol::Welcome& welcome, const std::vector<PlayedFrame>& frames);

}  // namespace iwalk::client
