#include "preprocess/build/verify_nesting.hpp"

#include <algorithm>

namespace iwalk {

CellPlace CellPlace::of(std::uint32_t path) {
    const unsigned levels = pathLevels(path);
    const std::uint64_t octants = path - (std::uint64_t{1} << 3 * levels);
    return {octants << 3 * (kKeyLevels - levels), levels};
}

CellPlace CellPlace::of(unsigned octant, std::uint32_t path) {
    const CellPlace below = of(path);
    return {std::uint64_t{octant} << 3 * (kKeyLevels - 1) | below.key >> 3, below.levels + 1};
}

bool CellPlace::contains(const CellPlace& inner) const {
    return inner.levels >= levels &&
           inner.key >> 3 * (kKeyLevels - levels) == key >> 3 * (kKeyLevels - levels);
}

// Of exactly that cell.
std::span<const CoarseRanges::Coarse> CoarseRanges::rangesAt(const CellPlace& place) const {
    const auto [first, last] = std::ranges::equal_range(ranges_, place, {}, &Coarse::place);
    return {first, last};
}

CoarseRanges::Found CoarseRanges::find(const CellPlace& place, const LatticeBox& box) const {
    if (ranges_.empty()) return {false, true};
    const auto boxed = [&](std::span<const Coarse> ranges) {
        return std::ranges::any_of(ranges, [&](const Coarse& range) { return range.box.contains(box); });
    };
    for (unsigned levels = std::min(place.levels, kMaxPathLevels) + 1; levels-- > 0;) {
        const unsigned below = 3 * (CellPlace::kKeyLevels - levels);
        const std::span<const Coarse> found = rangesAt({place.key >> below << below, levels});
        if (!found.empty()) return {true, boxed(found)};
    }
    const auto after = std::ranges::upper_bound(ranges_, place, {}, &Coarse::place);
    return {false, boxed(rangesAt((after == ranges_.begin() ? after : after - 1)->place))};
}

}  // namespace iwalk
