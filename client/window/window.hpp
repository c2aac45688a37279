#pragma once

#include "client/options.hpp"
#include "common/result.hpp"

namespace iwalk::client {

// Opens a window to fly the wall from; returns when it is closed. Fails without a display.
Result<void> flyByHand(const Options& options);

}  // namespace iwalk::client
