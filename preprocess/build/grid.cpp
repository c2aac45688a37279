#include "preprocess/build/grid.hpp"

#include "common/check.hpp"

namespace iwalk {
namespace {

// Two zero bits between the low 21 bits.
constexpr std::uint64_t spread(std::uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

// Preorder place of a bottom cell without the steps down: 73, 9 and 1 for each octant of the three levels.
constexpr std::array<std::uint16_t, 512> makePlaces() {
    std::array<std::uint16_t, 512> places{};
    for (std::size_t code = 0; code < places.size(); ++code) {
        places[code] = static_cast<std::uint16_t>(73 * (code >> 6) + 9 * (code >> 3 & 7) + (code & 7));
    }
    return places;
}
constexpr std::array<std::uint16_t, 512> kPlaces = makePlaces();

class Planner {
  public:
    Planner(std::span<const std::uint64_t> counts, std::uint64_t leafTriangles, const OldTree& tree,
            unsigned noLeaves)
        : leafTriangles_(leafTriangles), tree_(tree), noLeaves_(noLeaves) {
        CHECK_OP(counts.size(), ==, kGridBins);
        before_.push_back(0);
        for (const std::uint64_t count : counts) before_.push_back(before_.back() + count);
    }

    void visit(unsigned level, std::uint8_t octant, std::uint32_t parent, std::size_t bin,
               std::uint32_t old) {
        const std::uint64_t total = before_[bin + kBinsBelow[level]] - before_[bin];
        const bool wasSplit = tree_.isInterior(old);
        const bool isLeaf = total <= leafTriangles_ && !wasSplit && level >= noLeaves_;
        // A leaf that is split now is another node.
        const std::uint32_t origin = isLeaf || wasSplit ? old : OldTree::kNone;
        const auto add = [&](PlannedNode::Kind kind, std::size_t bins) {
            plan_.push_back({kind, static_cast<std::uint8_t>(level), octant, parent, bin, bins, origin});
        };
        if (total == 0 && old != OldTree::kNone) return add(PlannedNode::kKept, 0);
        if (total == 0) return;
        if (isLeaf) return add(PlannedNode::kLeaf, kBinsBelow[level]);
        if (level == kGridLevels) return add(PlannedNode::kSubtree, 1);
        const std::uint32_t self = static_cast<std::uint32_t>(plan_.size());
        add(PlannedNode::kInterior, 1);
        for (std::uint8_t child = 0; child < 8; ++child) {
            visit(level + 1, child, self, bin + 1 + child * kBinsBelow[level + 1],
                  tree_.child(origin, child));
        }
    }
    std::vector<PlannedNode> take() { return std::move(plan_); }

  private:
    std::uint64_t leafTriangles_;
    const OldTree& tree_;
    unsigned noLeaves_;
    std::vector<std::uint64_t> before_;  // triangles in the bins before each
    std::vector<PlannedNode> plan_;
};

}  // namespace

std::uint64_t morton(const CellPoint& p) {
    return spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2;
}

std::size_t binOf(const TrianglePlace& place, unsigned base, unsigned rootCellLog2) {
    const unsigned level = std::min(place.depth - base, kGridLevels);
    const unsigned shift = rootCellLog2 - base - level;
    const std::uint64_t mask = (std::uint64_t{1} << level) - 1;
    const CellPoint cell(place.centroid.x >> shift & mask, place.centroid.y >> shift & mask,
                         place.centroid.z >> shift & mask);
    return level + kPlaces[morton(cell) << 3 * (kGridLevels - level)];
}

std::uint64_t sortKey(const TrianglePlace& place, unsigned edgeLog2) {
    constexpr unsigned kAxisBits = kMortonKeyBits / 3;
    const std::uint64_t mask = (std::uint64_t{1} << edgeLog2) - 1;
    const unsigned shift = edgeLog2 > kAxisBits ? edgeLog2 - kAxisBits : 0;
    const CellPoint cell((place.centroid.x & mask) >> shift, (place.centroid.y & mask) >> shift,
                         (place.centroid.z & mask) >> shift);
    return morton(cell) << (kKeyBits - kMortonKeyBits) | place.depth;
}

std::vector<PlannedNode> planGrid(std::span<const std::uint64_t> binCounts, std::uint64_t leafTriangles,
                                  const OldTree& tree, std::uint32_t old, unsigned noLeaves) {
    Planner planner(binCounts, leafTriangles, tree, noLeaves);
    planner.visit(0, 0, kNoParent, 0, old);
    return planner.take();
}

}  // namespace iwalk
