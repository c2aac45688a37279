#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/build/page_job.hpp"

namespace iwalk {

// The triangles that one range of the finer level has left, and its box.
struct RunSource {
    std::uint64_t key = 0;  // Morton key of the range's cell in the entry's: kMortonKeyBits
    unsigned levels = 0;    // of the range's cell below the entry's
    std::size_t triangles = 0;
    LatticeBox box;
};

// Joins sources, in ascending order, to the ranges of an entry: a cell is split when it has more triangles
// than a range may, or when it is large for its level and has not just a few. Sources whose own cell is split
// make ranges of that cell; those without triangles add their boxes to the range before. So each source is in
// the last of the ranges that begin at or before it and contain it, or else in the one before it.
std::vector<Run> joinRanges(std::span<const RunSource> sources, unsigned leastLevels);

}  // namespace iwalk
