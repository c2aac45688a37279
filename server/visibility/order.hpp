#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace iwalk {

// The places of `keys`, none of them negative, the least key first or the greatest; equal ones as they come.
std::vector<std::uint32_t> leastFirst(std::span<const float> keys);
std::vector<std::uint32_t> greatestFirst(std::span<const float> keys);

}  // namespace iwalk
