// The box of a range's targets is much like the range's own: what is stored is by how much they differ.
#include "common/dataset/morph_boxes.hpp"

#include <algorithm>

#include "common/dataset/page_streams.hpp"

namespace iwalk {
namespace {

// The range's box, counted from another origin than its page's. It may reach beyond what 32 bits count from
// there, and so is modulo 2^32, as are differences to it.
MorphBox movedBox(const Range& range, const LatticePoint& pageOrigin, const LatticePoint& origin) {
    MorphBox box{};
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        const auto way = static_cast<std::uint32_t>(pageOrigin[axis] - origin[axis]);
        box.min[axis] = range.boxMin[axis] + way;
        box.max[axis] = range.boxMax[axis] + way;
    }
    return box;
}

MorphBox boxOf(const MorphSource& page, const Range& range, const LatticePoint& origin) {
    LatticeBox box;
    for (const std::uint16_t index : page.indices.subspan(range.firstIndex, range.indexCount)) {
        box.add(page.targets[index]);
    }
    MorphBox steps{};
    std::ranges::copy(offsetFrom(origin, box.min), steps.min);
    std::ranges::copy(offsetFrom(origin, box.max), steps.max);
    return steps;
}

}  // namespace

std::vector<std::byte> codeMorphBoxes(const MorphSource& page, const LatticePoint& origin) {
    std::vector<MorphBox> items;
    items.reserve(page.ranges.size());
    for (const Range& range : page.ranges) {
        const MorphBox base = movedBox(range, page.origin, origin);
        MorphBox& item = items.emplace_back(boxOf(page, range, origin));
        for (int axis = 0; axis < 3; ++axis) {
            item.min[axis] = zigzag(item.min[axis] - base.min[axis]);
            item.max[axis] = zigzag(item.max[axis] - base.max[axis]);
        }
    }
    return codeItems(items);
}

Result<std::vector<MorphBox>> decodeMorphBoxes(std::span<const std::byte> coded, const PageTable& table,
                                               const LatticePoint& origin) {
    ASSIGN_OR_RETURN(std::vector<MorphBox> boxes,
                     decodeItems<MorphBox>(coded, "morph boxes", table.ranges.size()));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const MorphBox base = movedBox(table.ranges[i], table.origin, origin);
        for (int axis = 0; axis < 3; ++axis) {
            boxes[i].min[axis] = base.min[axis] + unzigzag(boxes[i].min[axis]);
            boxes[i].max[axis] = base.max[axis] + unzigzag(boxes[i].max[axis]);
            if (boxes[i].min[axis] > boxes[i].max[axis]) return fail("morph box {}: is inside out", i);
        }
    }
    return boxes;
}

}  // namespace iwalk
