#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/visibility/plp_visibility.hpp"
#include "tests/bench/plp/original_plp.hpp"
#include "tests/bench/plp/owners.hpp"

namespace iwalk::bench {

// What all ways to choose work with.
struct Bench {
    Dataset dataset;
    Cut cut;
    CutPages pages;
    std::vector<LatticePoint> cells;  // of nodes
    double raysPerPixel = 0;
    std::unique_ptr<Workers> workers;
};

// One tile in one frame, and the truth about it.
struct Shot {
    TileSight sight;
    std::vector<Owned> owned;
};

// A way to choose what is drawn: ranges with at most `budget` triangles.
struct Method {
    std::string name;
    std::function<std::vector<VisibleRanges>(const Shot& shot, std::uint64_t budget)> choose;
};

// Ours, others by rays, the original, and two that know the truth.
std::vector<Method> allMethods(const Bench& bench, const OriginalPlp& original, OwnerRenders& renders);
// Ours.
Method modePlp(const Bench& bench, OwnerRenders& renders);

// Pixels of a tile that show what they would when nothing were missing, when the owners of all others are
// not drawn.
std::uint64_t correctPixels(const Shot& shot, const std::vector<VisibleRanges>& chosen);

}  // namespace iwalk::bench
