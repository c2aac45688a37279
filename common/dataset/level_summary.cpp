#include "common/dataset/level_summary.hpp"

#include <algorithm>
#include <cmath>

namespace iwalk {
namespace {

std::uint64_t trianglesAt(const Hierarchy& hierarchy, unsigned level) {
    std::uint64_t triangles = 0;
    for (const NodeRecord& node : hierarchy.nodes) {
        const LevelRecord* entry = hierarchy.drawnAt(node, level);
        if (entry != nullptr) triangles += entry->triangles;
    }
    return triangles;
}

// Pages belong to one level each.
std::vector<std::uint8_t> levelsOfPages(const Hierarchy& hierarchy) {
    std::vector<std::uint8_t> levels(hierarchy.pages.size(), kFullLevel);
    for (const LevelRecord& entry : hierarchy.entries) {
        std::fill_n(levels.begin() + entry.firstPage, entry.pageCount, entry.level);
    }
    return levels;
}

}  // namespace

LevelSummaries summariseLevels(const Hierarchy& hierarchy, int stepExponent) {
    LevelSummaries result;
    std::size_t count = 0;
    for (const LevelRecord& entry : hierarchy.entries) {
        if (entry.level != kFullLevel) count = std::max(count, std::size_t{entry.level} + 1);
    }
    for (unsigned level = 0; level < count; ++level) {
        const double error = std::ldexp(levelErrorSteps(hierarchy.rootCellLog2, level), stepExponent);
        result.levels.push_back({error, trianglesAt(hierarchy, level), 0});
    }
    result.full.triangles = trianglesAt(hierarchy, kFullLevel);
    const std::vector<std::uint8_t> levels = levelsOfPages(hierarchy);
    for (std::size_t p = 0; p < levels.size(); ++p) {
        LevelSummary& level = levels[p] == kFullLevel ? result.full : result.levels[levels[p]];
        level.bytes += std::uint64_t{hierarchy.pages[p].bytes} + hierarchy.pages[p].morphBytes;
    }
    return result;
}

}  // namespace iwalk
