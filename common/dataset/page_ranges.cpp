// Ranges follow one another, so that where they begin is not stored; and sides of boxes code better than
// their far corners.
#include "common/dataset/page_ranges.hpp"

#include "common/dataset/page_streams.hpp"

namespace iwalk {
namespace {

struct RangeItem {
    std::uint32_t triangles, path;
    std::uint32_t boxMin[3], boxSize[3];
};
static_assert(sizeof(RangeItem) == 32);

}  // namespace

std::vector<std::byte> codeRanges(const std::vector<Range>& ranges) {
    std::vector<RangeItem> items;
    items.reserve(ranges.size());
    for (const Range& range : ranges) {
        RangeItem& item = items.emplace_back();
        item.triangles = range.indexCount / 3;
        item.path = range.path;
        for (int axis = 0; axis < 3; ++axis) {
            item.boxMin[axis] = range.boxMin[axis];
            item.boxSize[axis] = range.boxMax[axis] - range.boxMin[axis];
        }
    }
    return codeItems(items);
}

Result<std::vector<Range>> decodeRanges(std::span<const std::byte> coded, const PageRecord& record) {
    ASSIGN_OR_RETURN(const std::vector<RangeItem> items,
                     decodeItems<RangeItem>(coded, "page ranges", record.rangeCount));
    std::vector<Range> ranges;
    ranges.reserve(items.size());
    std::uint32_t next = 0;
    for (const RangeItem& item : items) {
        const std::size_t i = ranges.size();
        if (item.triangles == 0 || item.triangles > (record.indexCount - next) / 3) {
            return fail("page range {}: {} triangles of {} that are left", i, item.triangles,
                        (record.indexCount - next) / 3);
        }
        if (!isPath(item.path)) return fail("page range {}: {:#x} is no path to a cell", i, item.path);
        Range& range = ranges.emplace_back(Range{next, 3 * item.triangles, item.path, {}, {}});
        for (int axis = 0; axis < 3; ++axis) {
            range.boxMin[axis] = item.boxMin[axis];
            range.boxMax[axis] = item.boxMin[axis] + item.boxSize[axis];
            if (range.boxMax[axis] < range.boxMin[axis]) return fail("page range {}: box is too large", i);
        }
        next += range.indexCount;
    }
    if (next == record.indexCount) return ranges;
    return fail("page ranges: cover {} of {} indices", next, record.indexCount);
}

}  // namespace iwalk
