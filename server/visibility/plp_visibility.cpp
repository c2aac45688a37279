#include "server/visibility/plp_visibility.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>
#include <unordered_set>

#include "server/visibility/boxes.hpp"

namespace iwalk {
namespace {

// Candidates have this many times the budget. More find more of what owns a pixel, and read more pages.
constexpr std::uint64_t kCandidateFactor = 6;

// What a range hides, compared with what the leaf's opacity says when it is spread over the volume of the
// leaf's ranges. Less than 1, as surfaces stand behind one another: rays find gaps more often than chance
// would have it. From 0.2 to 0.5 it makes little difference.
constexpr float kHiding = 0.35f;

// The optical depth of interior nodes' ranges, for which no opacity was measured.
constexpr float kUnknownDepth = 1;

struct Seen {
    PlpRange range;
    float density;   // optical depth per step
    float distance;  // of the middle of its box from the eye, squared and times 4
    float arriving;  // Candidate::arriving
    float score = 0;
};

glm::vec3 sidesOf(const Range& range) {
    glm::vec3 sides;
    for (glm::length_t axis = 0; axis < 3; ++axis)
        sides[axis] = static_cast<float>(range.boxMax[axis] - range.boxMin[axis]) + 1;  // inclusive corners
    return sides;
}

// Finds the ranges of candidates that are in the frustum, and scores them.
class RangeScores {
  public:
    RangeScores(const Hierarchy& hierarchy, const std::vector<LatticePoint>& cells,
                const PlpVisibility::Tables& tables, const TileSight& sight)
        : hierarchy_(hierarchy), cells_(cells), tables_(tables), sight_(sight), frustum_(sight.frustum()) {}

    void add(const PlpVisibility::Candidate& candidate) {
        const LevelRecord& entry = hierarchy_.entries[candidate.entry];
        const float density = densityOf(hierarchy_.nodes[candidate.node], cells_[candidate.node], entry);
        forRanges(entry, [&](std::uint32_t page, const PageTable& table, std::uint32_t index) {
            const Range& range = table.ranges[index];
            const glm::dvec3 origin = sight_.eye.to(table.origin);
            const glm::dvec3 low = origin + glm::dvec3(range.boxMin[0], range.boxMin[1], range.boxMin[2]);
            const glm::dvec3 high = origin + glm::dvec3(range.boxMax[0], range.boxMax[1], range.boxMax[2]);
            if (!meets(frustum_, low, high)) return;
            const EyeBox box{glm::vec3(low), glm::vec3(high)};
            const glm::vec3 middle = box.low + box.high;
            seen_.push_back({{page, index, range.indexCount / 3, box},
                             density,
                             glm::dot(middle, middle),
                             candidate.arriving});
        });
    }

    // By score, the highest first; equal ones in an order of their own.
    std::vector<PlpRange> ranked(double raysPerPixel) {
        std::sort(seen_.begin(), seen_.end(), [](const Seen& a, const Seen& b) {
            return std::tuple(a.distance, a.range.page, a.range.range) <
                   std::tuple(b.distance, b.range.page, b.range.range);
        });
        RayGrid rays(sight_.projection, sight_.tile, sight_.near, raysPerPixel);
        for (Seen& seen : seen_)
            seen.score = seen.arriving * rays.pass(seen.range.box, seen.density).contribution /
                         static_cast<float>(seen.range.triangles);
        std::stable_sort(seen_.begin(), seen_.end(),
                         [](const Seen& a, const Seen& b) { return a.score > b.score; });
        std::vector<PlpRange> ranges;
        ranges.reserve(seen_.size());
        for (const Seen& seen : seen_) ranges.push_back(seen.range);
        return ranges;
    }

  private:
    // What the entry hides, spread evenly over the volume of its ranges: optical depth per step.
    float densityOf(const NodeRecord& node, const LatticePoint& corner, const LevelRecord& entry) const {
        const double edge = std::ldexp(1.0, static_cast<int>(hierarchy_.rootCellLog2) - node.depth);
        const glm::dvec3 low = sight_.eye.to(corner);
        const glm::vec3 direction = directionTo(glm::vec3(low), glm::vec3(low + edge));
        float volume = 0, silhouettes = 0;
        forRanges(entry, [&](std::uint32_t, const PageTable& table, std::uint32_t index) {
            const glm::vec3 sides = sidesOf(table.ranges[index]);
            volume += sides.x * sides.y * sides.z;
            silhouettes += silhouetteArea(sides, direction);
        });
        if (volume <= 0) return 0;
        if (!Hierarchy::isLeaf(node)) return kHiding * kUnknownDepth * silhouettes / volume;
        const float cell = silhouetteArea(glm::vec3(static_cast<float>(edge)), direction);
        return kHiding * opticalDepth(node, direction) * cell / volume;
    }

    // f(page, its table, range) for the ranges of an entry, but those whose page cannot be read.
    template <class F>
    void forRanges(const LevelRecord& entry, const F& f) const {
        for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page) {
            const PageTable* table = tables_(page);
            if (table == nullptr) continue;
            const bool alone = entry.pageCount == 1;
            const std::uint32_t first = alone ? entry.firstRange : 0;
            const std::uint32_t count = alone ? entry.rangeCount : hierarchy_.pages[page].rangeCount;
            for (std::uint32_t range = first; range < first + count; ++range) f(page, *table, range);
        }
    }

    const Hierarchy& hierarchy_;
    const std::vector<LatticePoint>& cells_;
    const PlpVisibility::Tables& tables_;
    const TileSight& sight_;
    const Frustum frustum_;
    std::vector<Seen> seen_;
};

}  // namespace

PlpVisibility::PlpVisibility(const Hierarchy& hierarchy, std::uint64_t budget, double raysPerPixel)
    : hierarchy_(hierarchy), cells_(cellsOfNodes(hierarchy)), budget_(budget), raysPerPixel_(raysPerPixel) {}

std::vector<PlpVisibility::Candidate> PlpVisibility::candidates(const Cut& cut,
                                                                const TileSight& sight) const {
    std::vector<EntryPriority> entries = entryPriorities(hierarchy_, cells_, cut, sight, raysPerPixel_);
    const auto score = [&](const EntryPriority& e) {
        return e.contribution / static_cast<float>(std::max(1u, hierarchy_.entries[e.entry].triangles));
    };
    std::sort(entries.begin(), entries.end(), [&](const EntryPriority& a, const EntryPriority& b) {
        return std::tuple(-score(a), a.node) < std::tuple(-score(b), b.node);
    });

    std::vector<Candidate> found;
    std::uint64_t triangles = 0;
    for (const EntryPriority& e : entries) {
        if (triangles / kCandidateFactor >= budget_) break;
        triangles += hierarchy_.entries[e.entry].triangles;
        found.push_back({e.node, e.entry, e.rays > 0 ? e.contribution / e.rays : 1});
    }
    return found;
}

std::vector<std::uint32_t> PlpVisibility::pagesOf(const std::vector<Candidate>& candidates) const {
    std::vector<std::uint32_t> pages;
    std::unordered_set<std::uint32_t> known;
    for (const Candidate& candidate : candidates) {
        const LevelRecord& entry = hierarchy_.entries[candidate.entry];
        for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page)
            if (known.insert(page).second) pages.push_back(page);
    }
    return pages;
}

std::vector<PlpRange> PlpVisibility::ranges(const std::vector<Candidate>& candidates, const Tables& tables,
                                            const TileSight& sight) const {
    RangeScores scores(hierarchy_, cells_, tables, sight);
    for (const Candidate& candidate : candidates) scores.add(candidate);
    return scores.ranked(raysPerPixel_);
}

}  // namespace iwalk
