#include "preprocess/levels/entry_triangles.hpp"

#include <algorithm>

namespace iwalk {
namespace {

bool comesBefore(const CellPoint& a, const CellPoint& b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
}

// The place of the least corner: triangles are the same wherever they begin.
std::ptrdiff_t firstOf(const EntryTriangles::Corners& corners) {
    return std::ranges::min_element(corners, comesBefore) - corners.begin();
}

EntryTriangles::Corners cornersOf(const SourcePage& page, std::uint32_t firstIndex) {
    const std::uint16_t* const corner = &page.indices[firstIndex];
    return {page.positions[corner[0]], page.positions[corner[1]], page.positions[corner[2]]};
}

EntryTriangles::Attributes attributesAt(const SourcePage& page, std::uint32_t firstIndex) {
    const std::uint16_t* const corner = &page.indices[firstIndex];
    return {attributesOf(page, corner[0]), attributesOf(page, corner[1]), attributesOf(page, corner[2])};
}

}  // namespace

Result<void> EntryTriangles::read(const LevelRecord& entry, std::span<const PageRecord> records,
                                  PageStore& store) {
    const auto addPage = [&](std::uint32_t, const SourcePage& page, std::uint32_t first,
                             std::uint32_t count) -> Result<void> {
        forTriangles(page, first, count, [&](std::uint32_t i) { add(page, i); });
        return {};
    };
    return forPages(entry, records, store, addPage);
}

void EntryTriangles::add(const SourcePage& page, std::uint32_t firstIndex) {
    Corners corners = cornersOf(page, firstIndex);
    Attributes attributes = attributesAt(page, firstIndex);
    const std::ptrdiff_t first = firstOf(corners);
    std::rotate(corners.begin(), corners.begin() + first, corners.end());
    std::rotate(attributes.begin(), attributes.begin() + first, attributes.end());
    triangles_.try_emplace(corners, attributes);
}

std::optional<EntryTriangles::Attributes> EntryTriangles::find(Corners corners) const {
    const std::ptrdiff_t first = firstOf(corners);
    std::rotate(corners.begin(), corners.begin() + first, corners.end());
    const auto found = triangles_.find(corners);
    if (found == triangles_.end()) return std::nullopt;
    Attributes attributes = found->second;
    std::rotate(attributes.begin(), attributes.end() - first, attributes.end());
    return attributes;
}

bool EntryTriangles::has(const SourcePage& page, std::uint32_t firstIndex) const {
    return find(cornersOf(page, firstIndex)) == attributesAt(page, firstIndex);
}

VertexAttributes attributesOf(const SourcePage& page, std::uint16_t vertex) {
    return {page.colors.empty() ? 0 : page.colors[vertex], page.normals.empty() ? 0 : page.normals[vertex]};
}

}  // namespace iwalk
