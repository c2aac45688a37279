#include "tests/bench/plp/original_plp.hpp"

#include <bit>
#include <glm/geometric.hpp>
#include <queue>

#include "server/visibility/boxes.hpp"

namespace iwalk::bench {

OriginalPlp::OriginalPlp(const Hierarchy& hierarchy, const Cut& cut, std::uint64_t leafTriangles)
    : hierarchy_(hierarchy),
      cut_(cut),
      leafTriangles_(static_cast<double>(leafTriangles)),
      parents_(hierarchy.nodes.size(), kNobody) {
    for (std::uint32_t node = 0; node < hierarchy.nodes.size(); ++node)
        for (int c = 0; c < Hierarchy::childCount(hierarchy.nodes[node]); ++c)
            parents_[hierarchy.nodes[node].firstChild + static_cast<std::uint32_t>(c)] = node;
    addCell(hierarchy.rootCell, 0, 0);
    linkInside(0);
}

std::uint32_t OriginalPlp::addCell(const LatticePoint& corner, unsigned depth, std::uint32_t node) {
    const auto index = static_cast<std::uint32_t>(cells_.size());
    const bool leaf = node == kNobody || Hierarchy::isLeaf(hierarchy_.nodes[node]);
    cells_.push_back({corner, depth, node, {}, leaf, {}});
    if (leaf) return index;
    const NodeRecord& record = hierarchy_.nodes[node];
    const std::int64_t half = std::int64_t{1} << (hierarchy_.rootCellLog2 - depth - 1);
    std::uint32_t next = record.firstChild;
    for (unsigned octant = 0; octant < 8; ++octant) {
        const LatticePoint place = corner + half * LatticePoint(octant & 1, octant >> 1 & 1, octant >> 2 & 1);
        const bool there = record.childMask >> octant & 1;
        const std::uint32_t child = addCell(place, depth + 1, there ? next++ : kNobody);
        cells_[index].children[octant] = child;
    }
    return index;
}

// Links all leaves below a cell that share a face.
void OriginalPlp::linkInside(std::uint32_t cell) {
    if (cells_[cell].leaf) return;
    for (unsigned octant = 0; octant < 8; ++octant) {
        linkInside(cells_[cell].children[octant]);
        for (int axis = 0; axis < 3; ++axis)
            if (!(octant >> axis & 1))
                linkAcross(cells_[cell].children[octant], cells_[cell].children[octant | 1u << axis], axis);
    }
}

// Links the leaves of two cells that share a face across `axis`.
void OriginalPlp::linkAcross(std::uint32_t low, std::uint32_t high, int axis) {
    if (cells_[low].leaf && cells_[high].leaf) {
        cells_[low].neighbours.push_back({high, axis, 1});
        cells_[high].neighbours.push_back({low, axis, -1});
        return;
    }
    for (unsigned octant = 0; octant < 8; ++octant) {
        if (octant >> axis & 1) continue;
        linkAcross(cells_[low].leaf ? low : cells_[low].children[octant | 1u << axis],
                   cells_[high].leaf ? high : cells_[high].children[octant], axis);
    }
}

double OriginalPlp::solidity(const Cell& cell) const {
    if (cell.node == kNobody || cut_.entry[cell.node] == Cut::kNothing) return 0;
    return std::min(1.0, hierarchy_.entries[cut_.entry[cell.node]].triangles / leafTriangles_);
}

LatticeBox OriginalPlp::boxOf(const Cell& cell) const {
    return {cell.corner, cell.corner + (std::int64_t{1} << (hierarchy_.rootCellLog2 - cell.depth))};
}

std::uint32_t OriginalPlp::nearestCell(const Frustum& frustum, const LatticeEye& eye) const {
    std::uint32_t nearest = kNobody;
    double least = 0;
    for (std::uint32_t index = 0; index < cells_.size(); ++index) {
        if (!cells_[index].leaf || !meets(frustum, eye, boxOf(cells_[index]))) continue;
        const LatticeBox box = boxOf(cells_[index]);
        const glm::dvec3 outside = glm::max(glm::max(eye.to(box.min), -eye.to(box.max)), glm::dvec3(0));
        const double distance = glm::dot(outside, outside);
        if (nearest == kNobody || distance < least) nearest = index, least = distance;
    }
    return nearest;
}

std::vector<std::uint32_t> OriginalPlp::project(const TileSight& sight, std::uint64_t budget) const {
    const Frustum frustum = sight.frustum();
    std::vector<std::uint32_t> projected;
    std::uint64_t triangles = 0;
    std::vector<bool> taken(hierarchy_.nodes.size()), done(cells_.size());
    const auto take = [&](std::uint32_t node) {
        if (node == kNobody || taken[node]) return;
        taken[node] = true;
        if (cut_.entry[node] == Cut::kNothing) return;
        projected.push_back(cut_.entry[node]);
        triangles += hierarchy_.entries[cut_.entry[node]].triangles;
    };
    std::vector<double> priority(cells_.size(), 0);
    std::priority_queue<std::pair<double, std::uint32_t>> front;
    if (const std::uint32_t first = nearestCell(frustum, sight.eye); first != kNobody)
        front.emplace(priority[first] = 1, first);
    while (!front.empty() && triangles < budget) {
        const std::uint32_t index = front.top().second;
        front.pop();
        if (done[index]) continue;
        done[index] = true;
        const Cell& cell = cells_[index];
        for (std::uint32_t node = cell.node; node != kNobody; node = parents_[node]) take(node);

        const LatticeBox box = boxOf(cell);
        const glm::dvec3 middle = sight.eye.to(box.min) + sight.eye.to(box.max);
        const glm::dvec3 view = middle / std::max(1.0, glm::length(middle));
        for (const Neighbour& neighbour : cell.neighbours) {
            if (done[neighbour.cell] || !meets(frustum, sight.eye, boxOf(cells_[neighbour.cell]))) continue;
            const double cosine = view[static_cast<glm::length_t>(neighbour.axis)] * neighbour.side;
            const double left =
                priority[index] * (cosine > 0 ? 1 - solidity(cell) * cosine : 0.5 * (1 - solidity(cell)));
            if (left <= priority[neighbour.cell]) continue;
            front.emplace(priority[neighbour.cell] = left, neighbour.cell);
        }
    }
    return projected;
}

}  // namespace iwalk::bench
