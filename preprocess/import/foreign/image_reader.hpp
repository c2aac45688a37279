#pragma once

#include <string>

#include "preprocess/import/exchange.hpp"

namespace iwalk {

// Reads the first channel of an image, some rows at a time, and writes it as heights: integers as they are,
// floats as they are.
Result<void> exportHeights(const std::string& path, ExchangeWriter& out);

}  // namespace iwalk
