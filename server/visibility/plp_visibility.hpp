#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/dataset/page.hpp"
#include "server/visibility/entry_priority.hpp"
#include "server/visibility/ray_grid.hpp"

namespace iwalk {

// A range that meets the tile's frustum.
struct PlpRange {
    std::uint32_t page = 0, range = 0, triangles = 0;
    EyeBox box;
};

// Approximate visibility under a budget of triangles (`--mode plp`): ray-cast PLP in two steps.
//
// 1. candidates(): entries of the cut by what they show per triangle, from the hierarchy alone, until they
//    have several times the budget. Their pages are to be read.
// 2. ranges(): the same for the ranges of the candidates, whose boxes are in their pages, times what the
//    first step let through to their node.
//
// What of them is drawn says PlpSpending. Departures from Correa 2004, section 4.3.1, where nodes are drawn
// whole by the mean contribution of the rays that hit them (docs/results.md has the figures): leaves have up
// to 16,384 triangles, few of which own a pixel, so ranges are chosen; and what counts is the sum over rays
// for each triangle drawn: as many pixels as the budget can buy.
//
// The result depends on the dataset, the cut and the tile's view alone: not on what is resident, nor on how
// many threads there are.
class PlpVisibility {
  public:
    // An entry of the cut whose ranges are to be looked at.
    struct Candidate {
        std::uint32_t node = 0, entry = 0;  // indices in Hierarchy
        float arriving = 1;  // what a ray that meets its box has left on average; 1 if none does
    };
    // The table of a page, or nullptr where the page cannot be read: its ranges are left out. Called by all
    // threads.
    using Tables = std::function<const PageTable*(std::uint32_t page)>;

    // The hierarchy and the workers are kept by reference. `budget`: triangles; `raysPerPixel`: (0, 1].
    PlpVisibility(const Hierarchy& hierarchy, std::uint64_t budget, double raysPerPixel, Workers& workers);

    // By priority.
    std::vector<Candidate> candidates(const Cut& cut, const TileSight& sight) const;
    // Their pages, each once, in the order of the candidates.
    std::vector<std::uint32_t> pagesOf(const std::vector<Candidate>& candidates) const;

    // Their ranges in the tile's frustum, by priority.
    std::vector<PlpRange> ranges(const std::vector<Candidate>& candidates, const Tables& tables,
                                 const TileSight& sight) const;

  private:
    const Hierarchy& hierarchy_;
    const std::vector<LatticePoint> cells_;  // of nodes
    const std::uint64_t budget_;
    const double raysPerPixel_;
    Workers& workers_;
};

}  // namespace iwalk
