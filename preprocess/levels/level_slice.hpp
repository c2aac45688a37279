#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/build/page_job.hpp"
#include "preprocess/levels/page_store.hpp"
#include "preprocess/levels/targets.hpp"

namespace iwalk {

// Ranges of a page that belong to one entry, on their way into an entry of the next coarser level.
struct LevelSource {
    const SourcePage* page;
    const PageTargets* targets;  // nullptr: all stay where they are
    std::uint32_t firstRange, rangeCount;
    // The entry's node in the cell of the one that the level is made for: octants on the way down, 3 bits
    // each.
    std::uint64_t way;
    unsigned wayLevels;
};

// The image of the sources' triangles as one entry: what has become a line or a point is left out, and of
// triangles that have become equal only as many stay as it takes to keep the surface's border what it was.
// Triangles come in the order of their cells; ranges are smaller than `leastLevels` below the entry's cell
// unless they have few triangles.
Slice makeLevelSlice(const RecordFormat& format, const Lattice& lattice, std::span<const LevelSource> sources,
                     float errorLimit, unsigned leastLevels);

}  // namespace iwalk
