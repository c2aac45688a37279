#pragma once

#include <string>
#include <vector>

#include "tests/tools/compare.hpp"

namespace iwalk::tools {

// The measures for people, a line for each group, then "within what was asked" or what is broken.
std::string textReport(const Comparison& comparison, const std::vector<std::string>& broken);

// The same as a JSON object. `psnr_db` is null for equal images (it is infinite), pixels are [column, row]
// from the top left corner or null, shares are in [0, 1]; `depth` and `range` are there when they were
// measured.
std::string jsonReport(const Comparison& comparison, const std::vector<std::string>& broken);

}  // namespace iwalk::tools
