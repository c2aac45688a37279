#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/dataset/hierarchy.hpp"

namespace iwalk {

// One depth of the tree.
struct DepthSummary {
    std::uint64_t nodes = 0, leaves = 0;
    std::uint64_t triangles = 0;  // own triangles of the input
};

// What entries of one level there are.
struct StoredLevel {
    std::uint64_t entries = 0, pages = 0;
    std::uint64_t triangles =
        0;  // in these entries: more or less than what the whole model has at that level
};

constexpr std::size_t kOpacityBins = 10;

// What `info` says of a dataset beside its manifest.
struct Summary {
    std::vector<DepthSummary> depths;
    std::vector<StoredLevel> levels;  // from level 0 on
    StoredLevel full;
    std::uint64_t ranges = 0, triangles = 0, pageBytes = 0, morphBytes = 0, widePages = 0;  // in all pages
    bool hasOpacity = false;
    // Of all leaves and directions: opacities of [i / 10, (i + 1) / 10), and 1 in the last.
    std::array<std::uint64_t, kOpacityBins> opacities{};
};

Summary summarise(const Hierarchy& hierarchy);

}  // namespace iwalk
