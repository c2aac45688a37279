#include "server/visibility/plp_visibility.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_set>

#include "server/visibility/boxes.hpp"
#include "server/visibility/order.hpp"

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

// Candidates that a thread looks at together.
constexpr std::size_t kTogether = 8;

struct Seen {
    PlpRange range;
    float density = 0;   // optical depth per step
    float distance = 0;  // of the middle of its box from the eye, squared and times 4
    float arriving = 0;  // Candidate::arriving
};

glm::vec3 sidesOf(const Range& range) {
    glm::vec3 sides;
    for (glm::length_t axis = 0; axis < 3; ++axis)
        sides[axis] = static_cast<float>(range.boxMax[axis] - range.boxMin[axis]) + 1;  // inclusive corners
    return sides;
}

// Finds the ranges of candidates that are in the frustum. Threads use one together.
class RangesInView {
  public:
    RangesInView(const Hierarchy& hierarchy, const std::vector<LatticePoint>& cells,
                 const PlpVisibility::Tables& tables, const TileSight& sight)
        : hierarchy_(hierarchy), cells_(cells), tables_(tables), eye_(sight.eye), frustum_(sight.frustum()) {}

    void add(const PlpVisibility::Candidate& candidate, std::vector<Seen>& seen) const {
        const NodeRecord& node = hierarchy_.nodes[candidate.node];
        const LevelRecord& entry = hierarchy_.entries[candidate.entry];
        const LatticeBox all = Hierarchy::entryBox(node, entry);
        const bool inside = !all.empty() && contains(frustum_, eye_.to(all.min), eye_.to(all.max));
        const double edge = std::ldexp(1.0, static_cast<int>(hierarchy_.rootCellLog2) - node.depth);
        const glm::dvec3 corner = eye_.to(cells_[candidate.node]);
        const glm::vec3 direction = directionTo(glm::vec3(corner), glm::vec3(corner + edge));

        const std::size_t before = seen.size();
        float volume = 0, silhouettes = 0;  // of all its ranges
        forRanges(entry, [&](std::uint32_t page, const PageTable& table, std::uint32_t index) {
            const Range& range = table.ranges[index];
            const glm::vec3 sides = sidesOf(range);
            volume += sides.x * sides.y * sides.z;
            silhouettes += silhouetteArea(sides, direction);
            const glm::dvec3 origin = eye_.to(table.origin);
            const glm::dvec3 low = origin + glm::dvec3(range.boxMin[0], range.boxMin[1], range.boxMin[2]);
            const glm::dvec3 high = origin + glm::dvec3(range.boxMax[0], range.boxMax[1], range.boxMax[2]);
            if (!inside && !meets(frustum_, low, high)) return;
            const EyeBox box{glm::vec3(low), glm::vec3(high)};
            const glm::vec3 middle = box.low + box.high;
            seen.push_back(
                {{page, index, range.indexCount / 3, box}, 0, glm::dot(middle, middle), candidate.arriving});
        });
        const float cell = silhouetteArea(glm::vec3(static_cast<float>(edge)), direction);
        const float density = densityOf(node, direction, cell, volume, silhouettes);
        for (std::size_t i = before; i < seen.size(); ++i) seen[i].density = density;
    }

  private:
    // What the entry hides, spread evenly over the volume of its ranges: optical depth per step.
    static float densityOf(const NodeRecord& node, const glm::vec3& direction, float cell, float volume,
                           float silhouettes) {
        if (volume <= 0) return 0;
        if (!Hierarchy::isLeaf(node)) return kHiding * kUnknownDepth * silhouettes / volume;
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
    const LatticeEye eye_;
    const Frustum frustum_;
};

// The nearest middle first.
std::vector<const Seen*> fromNearToFar(const std::vector<std::vector<Seen>>& parts) {
    std::vector<const Seen*> all, ordered;
    std::vector<float> distances;
    for (const std::vector<Seen>& part : parts)
        for (const Seen& seen : part) {
            all.push_back(&seen);
            distances.push_back(seen.distance);
        }
    ordered.reserve(all.size());
    for (const std::uint32_t place : leastFirst(distances)) ordered.push_back(all[place]);
    return ordered;
}

}  // namespace

PlpVisibility::PlpVisibility(const Hierarchy& hierarchy, std::uint64_t budget, double raysPerPixel,
                             Workers& workers)
    : hierarchy_(hierarchy),
      cells_(cellsOfNodes(hierarchy)),
      budget_(budget),
      raysPerPixel_(raysPerPixel),
      workers_(workers) {}

std::vector<PlpVisibility::Candidate> PlpVisibility::candidates(const Cut& cut,
                                                                const TileSight& sight) const {
    const std::vector<EntryPriority> entries =
        entryPriorities(hierarchy_, cells_, cut, sight, raysPerPixel_, workers_);
    std::vector<float> scores;
    for (const EntryPriority& e : entries)
        scores.push_back(e.contribution /
                         static_cast<float>(std::max(1u, hierarchy_.entries[e.entry].triangles)));

    std::vector<Candidate> found;
    std::uint64_t triangles = 0;
    for (const std::uint32_t place : greatestFirst(scores)) {
        if (triangles / kCandidateFactor >= budget_) break;
        const EntryPriority& e = entries[place];
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
    const RangesInView inView(hierarchy_, cells_, tables, sight);
    std::vector<std::vector<Seen>> parts((candidates.size() + kTogether - 1) / kTogether);
    workers_.runParts(candidates.size(), kTogether, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) inView.add(candidates[i], parts[first / kTogether]);
    });
    const std::vector<const Seen*> seen = fromNearToFar(parts);

    std::vector<RayGrid::Pass> passes;
    passes.reserve(seen.size());
    for (const Seen* s : seen) passes.push_back({s->range.box, s->density});
    const std::vector<RayGrid::Arrival> arrivals =
        RayGrid(sight.projection, sight.tile, sight.near, raysPerPixel_).cross(passes, workers_);

    std::vector<float> scores;
    scores.reserve(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i)
        scores.push_back(seen[i]->arriving * arrivals[i].contribution /
                         static_cast<float>(std::max(1u, seen[i]->range.triangles)));
    std::vector<PlpRange> ranges;
    ranges.reserve(seen.size());
    for (const std::uint32_t place : greatestFirst(scores)) ranges.push_back(seen[place]->range);
    return ranges;
}

}  // namespace iwalk
