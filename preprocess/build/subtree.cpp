#include "preprocess/build/subtree.hpp"

#include <algorithm>

#include "preprocess/build/grid.hpp"

namespace iwalk {
namespace {

class Grower {
  public:
    Grower(const RecordFormat& format, const std::uint32_t* records, std::uint64_t leafTriangles,
           const OldTree& tree, std::size_t count)
        : format_(format),
          records_(records),
          leafTriangles_(leafTriangles),
          tree_(tree),
          bins_(count),
          other_(count) {}

    // order[0] is triangle `first` of the whole order.
    void grow(std::span<std::uint32_t> order, std::size_t first, unsigned depth, std::uint32_t parent,
              std::uint8_t octant, std::uint32_t old) {
        const std::vector<std::uint64_t> counts = sortIntoBins(order, depth);
        std::vector<std::size_t> starts{0};
        for (const std::uint64_t count : counts)
            starts.push_back(starts.back() + static_cast<std::size_t>(count));

        std::vector<std::uint32_t> numbers;  // of planned nodes
        const unsigned noLeaves = levelsWithoutLeaves(depth, format_.rootCellLog2());
        for (const PlannedNode& planned : planGrid(counts, leafTriangles_, tree_, old, noLeaves)) {
            const bool isRoot = planned.parent == kNoParent;
            const std::uint32_t up = isRoot ? parent : numbers[planned.parent];
            const std::uint8_t where = isRoot ? octant : planned.octant;
            const std::size_t begin = starts[planned.firstBin];
            const std::size_t count = starts[planned.firstBin + planned.binCount] - begin;
            numbers.push_back(static_cast<std::uint32_t>(result_.nodes.size()));
            if (planned.kind == PlannedNode::kSubtree) {
                grow(order.subspan(begin, count), first + begin, depth + kGridLevels, up, where, planned.old);
                continue;
            }
            result_.nodes.push_back({up, where, static_cast<std::uint8_t>(depth + planned.level), planned.old,
                                     planned.kind == PlannedNode::kKept});
            if (count > 0) result_.owned.push_back({numbers.back(), first + begin, count});
        }
    }
    Subtree take() { return std::move(result_); }

  private:
    // Stable.
    std::vector<std::uint64_t> sortIntoBins(std::span<std::uint32_t> order, unsigned depth) {
        std::vector<std::uint64_t> counts(kGridBins, 0);
        for (std::size_t i = 0; i < order.size(); ++i) {
            const TrianglePlace place = format_.place(records_ + order[i] * format_.words());
            bins_[i] = static_cast<std::uint16_t>(binOf(place, depth, format_.rootCellLog2()));
            ++counts[bins_[i]];
        }
        std::vector<std::size_t> next(kGridBins, 0);
        for (std::size_t bin = 1; bin < kGridBins; ++bin) {
            next[bin] = next[bin - 1] + static_cast<std::size_t>(counts[bin - 1]);
        }
        for (std::size_t i = 0; i < order.size(); ++i) other_[next[bins_[i]]++] = order[i];
        std::copy_n(other_.begin(), order.size(), order.begin());
        return counts;
    }

    const RecordFormat& format_;
    const std::uint32_t* records_;
    std::uint64_t leafTriangles_;
    const OldTree& tree_;
    std::vector<std::uint16_t> bins_;
    std::vector<std::uint32_t> other_;
    Subtree result_;
};

}  // namespace

Subtree growSubtree(const RecordFormat& format, const std::uint32_t* records, std::span<std::uint32_t> order,
                    unsigned depth, std::uint8_t octant, std::uint64_t leafTriangles, const OldTree& tree,
                    std::uint32_t old) {
    Grower grower(format, records, leafTriangles, tree, order.size());
    grower.grow(order, 0, depth, kNoParent, octant, old);
    return grower.take();
}

}  // namespace iwalk
