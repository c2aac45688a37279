#include "server/visibility/entry_priority.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "common/dataset/opacity.hpp"
#include "server/visibility/boxes.hpp"
#include "server/visibility/ray_grid.hpp"

namespace iwalk {
namespace {

// Octants that differ in more axes from the eye's own lie behind those that differ in fewer of them.
constexpr std::array<unsigned, 8> kBackToFront{7, 6, 5, 3, 4, 2, 1, 0};

// One walk through the tree.
class Walk {
  public:
    Walk(const Hierarchy& hierarchy, const std::vector<LatticePoint>& cells, const Cut& cut,
         const TileSight& sight)
        : hierarchy_(hierarchy), cells_(cells), cut_(cut), eye_(sight.eye), frustum_(sight.frustum()) {}

    // Finds what rays are to cross, and sends them.
    std::vector<EntryPriority> run(RayGrid rays, Workers& workers) {
        open_.push_back(0);
        while (!open_.empty()) {
            const std::uint32_t index = open_.back();
            open_.pop_back();
            const NodeRecord& node = hierarchy_.nodes[index];
            if (!meets(frustum_, eye_, Hierarchy::box(node))) continue;
            if (cut_.entry[index] != Cut::kNothing) reach(index, cut_.entry[index]);
            if (Hierarchy::isLeaf(node))
                crossLeaf(index);
            else
                openChildren(index);
        }
        const std::vector<RayGrid::Arrival> arrivals = rays.cross(passes_, workers);
        for (std::size_t i = 0; i < found_.size(); ++i) {
            const RayGrid::Arrival& arrival = arrivals[passOf_[i]];
            found_[i].rays = arrival.rays;
            found_[i].contribution = arrival.contribution;
        }
        return std::move(found_);
    }

  private:
    void reach(std::uint32_t index, std::uint32_t entry) {
        const LatticeBox box = Hierarchy::entryBox(hierarchy_.nodes[index], hierarchy_.entries[entry]);
        if (box.empty()) return;
        const glm::dvec3 low = eye_.to(box.min), high = eye_.to(box.max);
        if (!meets(frustum_, low, high)) return;
        found_.push_back({index, entry});
        passOf_.push_back(passes_.size());
        passes_.push_back({{glm::vec3(low), glm::vec3(high)}, 0});
    }

    void crossLeaf(std::uint32_t index) {
        const NodeRecord& leaf = hierarchy_.nodes[index];
        const double edge = edgeOf(leaf);
        const glm::dvec3 corner = eye_.to(cells_[index]);
        const EyeBox cell{glm::vec3(corner), glm::vec3(corner + edge)};
        const glm::vec3 direction = directionTo(cell.low, cell.high);
        const float meanLength = static_cast<float>(edge) / silhouetteArea(glm::vec3(1), direction);
        passes_.push_back({cell, opticalDepth(leaf, direction) / meanLength});
    }

    void openChildren(std::uint32_t index) {
        const NodeRecord& node = hierarchy_.nodes[index];
        const glm::dvec3 middle = eye_.to(cells_[index]) + edgeOf(node) / 2;
        const unsigned eyeOctant =
            (middle.x <= 0 ? 1u : 0u) | (middle.y <= 0 ? 2u : 0u) | (middle.z <= 0 ? 4u : 0u);
        for (const unsigned away : kBackToFront) {
            const unsigned octant = eyeOctant ^ away;
            if (!(node.childMask >> octant & 1)) continue;
            const unsigned before = node.childMask & ((1u << octant) - 1);
            open_.push_back(node.firstChild + static_cast<std::uint32_t>(std::popcount(before)));
        }
    }

    double edgeOf(const NodeRecord& node) const {
        return std::ldexp(1.0, static_cast<int>(hierarchy_.rootCellLog2) - node.depth);
    }

    const Hierarchy& hierarchy_;
    const std::vector<LatticePoint>& cells_;
    const Cut& cut_;
    const LatticeEye eye_;
    const Frustum frustum_;
    std::vector<std::uint32_t> open_;    // nodes, the nearest at the end
    std::vector<RayGrid::Pass> passes_;  // boxes of entries, and cells of leaves
    std::vector<EntryPriority> found_;
    std::vector<std::size_t> passOf_;  // of found_
};

}  // namespace

float opticalDepth(const NodeRecord& leaf, const glm::vec3& direction) {
    constexpr float kMost = 254.5f / 255;  // what is rounded to 255 may let something through
    const float opacity = static_cast<float>(leaf.opacity[nearestDirection(direction)]) / 255;
    return -std::log(1 - std::min(opacity, kMost));
}

float silhouetteArea(const glm::vec3& sides, const glm::vec3& direction) {
    return glm::dot(glm::vec3(sides.y * sides.z, sides.z * sides.x, sides.x * sides.y), glm::abs(direction));
}

glm::vec3 directionTo(const glm::vec3& low, const glm::vec3& high) {
    const glm::vec3 middle = low * 0.5f + high * 0.5f;
    const float length = glm::length(middle);
    return length > 0 ? middle / length : glm::vec3(1, 0, 0);
}

std::vector<EntryPriority> entryPriorities(const Hierarchy& hierarchy, const std::vector<LatticePoint>& cells,
                                           const Cut& cut, const TileSight& sight, double raysPerPixel,
                                           Workers& workers) {
    return Walk(hierarchy, cells, cut, sight)
        .run(RayGrid(sight.projection, sight.tile, sight.near, raysPerPixel), workers);
}

}  // namespace iwalk
