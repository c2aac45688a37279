#include "server/visibility/frustum_visibility.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <tuple>

#include "server/visibility/boxes.hpp"

namespace iwalk {
namespace {

double squaredDistance(const LatticeEye& eye, const LatticeBox& box) {
    const glm::dvec3 low = eye.to(box.min), high = eye.to(box.max);
    const glm::dvec3 outside = glm::max(glm::max(low, -high), glm::dvec3(0));
    return glm::dot(outside, outside);
}

void addEntry(const Hierarchy& hierarchy, const LevelRecord& entry, std::vector<VisibleRanges>& found) {
    if (entry.pageCount == 1) {
        found.push_back({entry.firstPage, entry.firstRange, entry.rangeCount});
        return;
    }
    for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page)
        found.push_back({page, 0, hierarchy.pages[page].rangeCount});
}

}  // namespace

FrustumVisibility::FrustumVisibility(const Hierarchy& hierarchy)
    : hierarchy_(hierarchy), pageBoxes_(hierarchy.pages.size()) {
    for (const NodeRecord& node : hierarchy.nodes)
        for (const LevelRecord& entry : hierarchy.entriesOf(node))
            for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page)
                pageBoxes_[page].add(Hierarchy::entryBox(node, entry));
}

std::vector<VisibleRanges> FrustumVisibility::visible(const Cut& cut, const Frustum& frustum,
                                                      const LatticeEye& eye) const {
    // Walk the tree from the root, leaving out what lies outside as a whole.
    std::vector<VisibleRanges> found;
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
        const std::uint32_t index = open.back();
        open.pop_back();
        const NodeRecord& node = hierarchy_.nodes[index];
        if (!meets(frustum, eye, Hierarchy::box(node))) continue;
        if (cut.entry[index] != Cut::kNothing) {
            const LevelRecord& entry = hierarchy_.entries[cut.entry[index]];
            const bool whole = Hierarchy::isWhole(node, entry);
            if (whole || meets(frustum, eye, Hierarchy::ownBox(node))) addEntry(hierarchy_, entry, found);
            if (whole) continue;
        }
        for (int c = 0; c < Hierarchy::childCount(node); ++c)
            open.push_back(node.firstChild + static_cast<std::uint32_t>(c));
    }
    sortFrontToBack(found, eye);
    return found;
}

void FrustumVisibility::sortFrontToBack(std::vector<VisibleRanges>& found, const LatticeEye& eye) const {
    std::vector<std::pair<double, VisibleRanges>> order;
    order.reserve(found.size());
    for (const VisibleRanges& ranges : found)
        order.emplace_back(squaredDistance(eye, pageBoxes_[ranges.page]), ranges);
    std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
        return std::tuple(a.first, a.second.page, a.second.firstRange) <
               std::tuple(b.first, b.second.page, b.second.firstRange);
    });
    std::transform(order.begin(), order.end(), found.begin(), [](const auto& entry) { return entry.second; });
}

std::uint32_t cullRanges(const PageTable& table, std::uint32_t first, std::uint32_t count,
                         const Frustum& frustum, const LatticeEye& eye, std::vector<IndexRun>& runs) {
    const glm::dvec3 origin = eye.to(table.origin);
    std::uint32_t kept = 0;
    for (std::uint32_t r = first; r < first + count; ++r) {
        const Range& range = table.ranges[r];
        const glm::dvec3 low(range.boxMin[0], range.boxMin[1], range.boxMin[2]);
        const glm::dvec3 high(range.boxMax[0], range.boxMax[1], range.boxMax[2]);
        if (!meets(frustum, origin + low, origin + high)) continue;
        ++kept;
        if (!runs.empty() && runs.back().firstIndex + runs.back().indexCount == range.firstIndex)
            runs.back().indexCount += range.indexCount;
        else
            runs.push_back({range.firstIndex, range.indexCount});
    }
    return kept;
}

}  // namespace iwalk
