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
        found.push_back({entry.firstPage, entry.firstRange, entry.rangeCount, 0});
        return;
    }
    for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page)
        found.push_back({page, 0, hierarchy.pages[page].rangeCount, 0});
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
    for (std::size_t i = 1; i < found.size(); ++i)
        found[i].rank = found[i - 1].rank + (found[i].page != found[i - 1].page ? 1 : 0);
}

std::vector<VisibleRanges> joined(std::vector<VisibleRanges> ranges) {
    std::sort(ranges.begin(), ranges.end(), [](const VisibleRanges& a, const VisibleRanges& b) {
        return std::tuple(a.page, a.firstRange) < std::tuple(b.page, b.firstRange);
    });
    std::vector<VisibleRanges> whole;
    for (const VisibleRanges& next : ranges) {
        const std::uint32_t end = whole.empty() ? 0 : whole.back().firstRange + whole.back().rangeCount;
        const bool samePage = !whole.empty() && whole.back().page == next.page;
        if (samePage && next.firstRange < end) continue;
        if (samePage && next.firstRange == end && whole.back().turn == next.turn)
            whole.back().rangeCount += next.rangeCount;
        else
            whole.push_back(next);
    }
    return whole;
}

void cullRanges(const PageTable& table, const VisibleRanges& some, const Frustum& frustum,
                const BoxProjection& projection, const LatticeEye& eye, std::vector<DrawnRange>& ranges) {
    const auto add = [&](std::uint32_t r, const glm::dvec3& low, const glm::dvec3& high) {
        const ScreenBox box = projection.of(low, high);
        const Range& range = table.ranges[r];
        if (!box.empty()) ranges.push_back({r, range.firstIndex, range.indexCount, box, some.turn});
    };
    forRangesIn(table, some.firstRange, some.rangeCount, frustum, eye, add);
}

}  // namespace iwalk
