#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/page.hpp"
#include "server/adapt/cut.hpp"
#include "server/visibility/eye.hpp"
#include "server/wall/projection.hpp"

namespace iwalk {

// Ranges of one page that may be seen: [firstRange, firstRange + rangeCount), before they are culled one by
// one.
struct VisibleRanges {
    std::uint32_t page = 0, firstRange = 0, rangeCount = 0;
};

// A contiguous run of a page's indices.
struct IndexRun {
    std::uint32_t firstIndex = 0, indexCount = 0;
};

// Visibility by the frustum alone (`--mode frustum`): everything of the cut whose box meets it.
class FrustumVisibility {
  public:
    explicit FrustumVisibility(const Hierarchy& hierarchy);  // kept by reference

    // Front to back; frustum in lattice steps.
    std::vector<VisibleRanges> visible(const Cut& cut, const Frustum& frustum, const LatticeEye& eye) const;

    // By the distance of pages' boxes from the eye; what belongs to one page stands together. The order of
    // any two pages depends on the eye and the dataset alone, so that tiles, threads, caches and modes draw
    // equal depths in the same order.
    void sortFrontToBack(std::vector<VisibleRanges>& found, const LatticeEye& eye) const;

  private:
    const Hierarchy& hierarchy_;
    std::vector<LatticeBox> pageBoxes_;  // around all entries of a page
};

// The ranges among `table.ranges[first, first + count)` whose boxes meet the frustum, neighbours joined to
// runs. Appends to `runs`; the result is the number of ranges kept.
std::uint32_t cullRanges(const PageTable& table, std::uint32_t first, std::uint32_t count,
                         const Frustum& frustum, const LatticeEye& eye, std::vector<IndexRun>& runs);

}  // namespace iwalk
