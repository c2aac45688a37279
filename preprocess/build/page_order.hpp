#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/dataset/hierarchy.hpp"
#include "common/dataset/manifest.hpp"

namespace iwalk {

// Leaves of the pages those in `order`, by number, and in that order. Entries use no others, and pages of one
// entry stay behind one another.
void keepPages(Hierarchy& hierarchy, std::span<const std::uint32_t> order);

// The numbers of the pages that entries use, ascending.
std::vector<std::uint32_t> usedPages(const Hierarchy& hierarchy);

// Leaves of `files`, which page records name, those that a page or a morph block lies in.
void keepFiles(std::vector<DatasetFile>& files, std::span<PageRecord> pages);

}  // namespace iwalk
