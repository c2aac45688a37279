#pragma once

#include "tests/tools/levels/range_model.hpp"

namespace iwalk::levels {

// Closes an open input: every open edge gets a triangle to one far place that never moves, in the range that
// has the edge and, for the edge's images, in the coarser ranges around it. Level for level this is what
// simplifying does to the border, so a cut without cracks is closed then, as for a closed input. Returns the
// number of open edges that there were.
std::size_t closeInput(RangeModel& model);

}  // namespace iwalk::levels
