#pragma once

#include <string>

#include "tests/tools/levels/tube.hpp"

namespace iwalk::levels {

// Writes the tube as a dataset: a root with level 0, and two leaves with level 1 and full, side by side in x.
// One lattice step is half a model unit.
void writeTube(const std::string& dataset);

}  // namespace iwalk::levels
