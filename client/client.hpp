#pragma once

#include <string>

#include "client/options.hpp"
#include "client/playback.hpp"
#include "common/result.hpp"

namespace iwalk::client {

// The whole program but its command line: connects, plays, captures, reports. The value is one line for the
// person at the keyboard: frames, times, and where the pictures are. What was captured before an error stays.
Result<std::string> run(const Options& options, const Playback::Progress& progress);

}  // namespace iwalk::client
