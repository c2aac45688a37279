#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

// Which dataset, in which state: XXH64 (seed 0) of all bytes of its manifest, which names everything else.
Result<std::uint64_t> datasetMark(const std::string& dataset);

// What a rank says of its dataset, and what all ranks have said, by rank, judged: it is the same one
// everywhere, or the first two that differ are named.
std::string datasetNote(std::uint64_t mark, const std::string& dataset);
Result<void> sameDataset(const std::vector<std::string>& notes, const std::vector<std::string>& hosts);

}  // namespace iwalk
