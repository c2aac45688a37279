#pragma once

namespace iwalk::client {

// The keys, in the middle of the window.
void drawHelp();

}  // namespace iwalk::client
