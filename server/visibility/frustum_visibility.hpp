#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/page.hpp"
#include "server/adapt/cut.hpp"
#include "server/visibility/boxes.hpp"
#include "server/visibility/eye.hpp"
#include "server/visibility/screen_box.hpp"
#include "server/wall/projection.hpp"

namespace iwalk {

// Ranges of one page that may be seen: [firstRange, firstRange + rangeCount), before they are culled one by
// one.
struct VisibleRanges {
    std::uint32_t page = 0, firstRange = 0, rangeCount = 0;
    std::uint32_t rank = 0;  // of the page in the order of all that the frustum has; decides equal depths
    std::uint8_t turn = 0;   // 0 to kTurns - 1: when mode plp has chosen them
};
constexpr unsigned kTurns = 16;

// The same ranges, by page and place in it, each once; neighbours of one turn are one.
std::vector<VisibleRanges> joined(std::vector<VisibleRanges> ranges);

// A range that is drawn.
struct DrawnRange {
    std::uint32_t range = 0;  // of its page
    std::uint32_t firstIndex = 0, indexCount = 0;
    ScreenBox box;          // nothing of it is drawn nearer than that
    std::uint8_t turn = 0;  // VisibleRanges::turn
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

    // Around all that a page has, lattice.
    const LatticeBox& pageBox(std::uint32_t page) const { return pageBoxes_[page]; }

    // About: pages' triangles by the share of their ranges.
    std::uint64_t trianglesOf(const VisibleRanges& ranges) const {
        const PageRecord& page = hierarchy_.pages[ranges.page];
        return std::uint64_t{page.indexCount} / 3 * ranges.rangeCount / page.rangeCount;
    }

  private:
    const Hierarchy& hierarchy_;
    std::vector<LatticeBox> pageBoxes_;  // around all entries of a page
};

// Calls use(number, low, high) for those of the ranges `table.ranges[first, first + count)` whose boxes meet
// the frustum: [low, high] is the box from the eye, steps.
template <class Use>
void forRangesIn(const PageTable& table, std::uint32_t first, std::uint32_t count, const Frustum& frustum,
                 const LatticeEye& eye, const Use& use) {
    const glm::dvec3 origin = eye.to(table.origin);
    for (std::uint32_t r = first; r < first + count; ++r) {
        const Range& range = table.ranges[r];
        const glm::dvec3 low = origin + glm::dvec3(range.boxMin[0], range.boxMin[1], range.boxMin[2]);
        const glm::dvec3 high = origin + glm::dvec3(range.boxMax[0], range.boxMax[1], range.boxMax[2]);
        if (meets(frustum, low, high)) use(r, low, high);
    }
}

// Appends those of a page's ranges that may have a pixel in the frustum.
void cullRanges(const PageTable& table, const VisibleRanges& some, const Frustum& frustum,
                const BoxProjection& projection, const LatticeEye& eye, std::vector<DrawnRange>& ranges);

}  // namespace iwalk
