#pragma once

#include <cstddef>

namespace iwalk::testing {

// The largest single allocation (bytes) of this thread since resetLargestAllocation(). This program replaces
// operator new to know.
std::size_t largestAllocation();
void resetLargestAllocation();

}  // namespace iwalk::testing
