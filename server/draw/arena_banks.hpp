#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

// GL buffers of at least `bytes` together, a multiple of `alignment`, each small enough for a shader to read
// as one, and mapped for as long as they live; `banks` gets their names.
Result<std::vector<std::span<std::byte>>> makeArenaBanks(std::uint64_t bytes, std::uint64_t alignment,
                                                         std::vector<std::uint32_t>& banks);

}  // namespace iwalk
