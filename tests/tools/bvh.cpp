#include "tests/tools/bvh.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/check.hpp"

// Binned surface area heuristic (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"),
// along the longest axis of the centroids only: a judge in tests need not be faster.
namespace iwalk::tools {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
constexpr std::size_t kBins = 16;
// Below this depth ranges are halved, so that the tree ends within kMaxDepth: 2^32 triangles need 32 more
// levels.
constexpr int kHeuristicDepth = Bvh::kMaxDepth - 33;

struct Range {
    std::uint32_t node, begin, end;  // triangles order[begin, end)
    int depth;
};

double area(const ModelBox& box) {
    if (box.empty()) return 0;
    const glm::dvec3 d = box.max - box.min;
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

class Builder {
  public:
    explicit Builder(const std::vector<Triangle>& triangles)
        : boxes_(triangles.size()), centers_(triangles.size()) {
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            for (const glm::dvec3& corner : triangles[i]) boxes_[i].add(corner);
            centers_[i] = 0.5 * boxes_[i].min + 0.5 * boxes_[i].max;
        }
        bvh_.order.resize(triangles.size());
        std::iota(bvh_.order.begin(), bvh_.order.end(), 0u);
    }

    Bvh build() && {
        if (boxes_.empty()) return std::move(bvh_);
        bvh_.nodes.resize(1);
        std::vector<Range> todo{{0, 0, static_cast<std::uint32_t>(boxes_.size()), 0}};
        while (!todo.empty()) {
            const Range range = todo.back();
            todo.pop_back();
            const std::uint32_t middle = finishNode(range);
            if (middle == range.end) continue;
            const std::uint32_t children = bvh_.nodes[range.node].first;
            todo.push_back({children, range.begin, middle, range.depth + 1});
            todo.push_back({children + 1, middle, range.end, range.depth + 1});
        }
        return std::move(bvh_);
    }

  private:
    // Makes a leaf and returns range.end, or makes room for two children and returns where the second begins.
    std::uint32_t finishNode(const Range& range) {
        Bvh::Node node{{}, range.begin, range.end - range.begin};
        ModelBox centers;
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            node.box.add(boxes_[bvh_.order[i]]);
            centers.add(centers_[bvh_.order[i]]);
        }
        std::uint32_t middle = range.end;
        if (node.count > kLeafTriangles) {
            middle = split(range, centers);
            node.count = 0;
            node.first = static_cast<std::uint32_t>(bvh_.nodes.size());
            bvh_.nodes.resize(bvh_.nodes.size() + 2);
        }
        CHECK_OP(range.depth, <=, Bvh::kMaxDepth);
        bvh_.nodes[range.node] = node;
        return middle;
    }

    std::uint32_t split(const Range& range, const ModelBox& centers) {
        const glm::dvec3 size = centers.max - centers.min;
        const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const auto begin = bvh_.order.begin() + range.begin, end = bvh_.order.begin() + range.end;
        if (size[axis] > 0 && range.depth < kHeuristicDepth) {
            auto binOf = [&, low = centers.min[axis], scale = kBins / size[axis]](std::uint32_t triangle) {
                return std::min(kBins - 1,
                                static_cast<std::size_t>((centers_[triangle][axis] - low) * scale));
            };
            const std::size_t bin = bestBin(range, binOf);
            const auto middle = std::partition(begin, end, [&](std::uint32_t t) { return binOf(t) < bin; });
            if (middle != begin && middle != end)
                return static_cast<std::uint32_t>(middle - bvh_.order.begin());
        }
        const auto half = begin + (end - begin) / 2;
        std::nth_element(begin, half, end, [&](std::uint32_t a, std::uint32_t b) {
            return centers_[a][axis] < centers_[b][axis];
        });
        return static_cast<std::uint32_t>(half - bvh_.order.begin());
    }

    // The bin where the second half should begin, 1..kBins-1.
    template <class BinOf>
    std::size_t bestBin(const Range& range, BinOf binOf) const {
        std::array<ModelBox, kBins> boxes;
        std::array<double, kBins> counts{};
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const std::size_t bin = binOf(bvh_.order[i]);
            boxes[bin].add(boxes_[bvh_.order[i]]);
            counts[bin] += 1;
        }
        // Costs of everything before a bin from the left, then of the rest from the right.
        std::array<double, kBins> costs{};
        ModelBox box;
        double count = 0;
        for (std::size_t bin = 1; bin < kBins; ++bin) {
            box.add(boxes[bin - 1]);
            costs[bin] = area(box) * (count += counts[bin - 1]);
        }
        box = {}, count = 0;
        for (std::size_t bin = kBins - 1; bin > 0; --bin) {
            box.add(boxes[bin]);
            costs[bin] += area(box) * (count += counts[bin]);
        }
        return static_cast<std::size_t>(std::min_element(costs.begin() + 1, costs.end()) - costs.begin());
    }

    std::vector<ModelBox> boxes_;
    std::vector<glm::dvec3> centers_;
    Bvh bvh_;
};

}  // namespace

Bvh buildBvh(const std::vector<Triangle>& triangles) {
    CHECK_OP(triangles.size(), <, std::numeric_limits<std::uint32_t>::max());
    return Builder(triangles).build();
}

}  // namespace iwalk::tools
