#include "tests/tools/levels/surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "common/check.hpp"

namespace iwalk::levels {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
// Below this depth parts are halved by count, so that the tree ends: 2^32 triangles need 32 more levels.
constexpr int kMiddleDepth = 60;
constexpr std::size_t kMaxDepth = kMiddleDepth + 33;

std::int32_t halfWay(std::int32_t low, std::int32_t high) {
    return static_cast<std::int32_t>((std::int64_t{low} + high) >> 1);
}

// The middle of a triangle's box.
Corner middleOf(const FixedTriangle& t) {
    const Corner low = glm::min(glm::min(t[0], t[1]), t[2]), high = glm::max(glm::max(t[0], t[1]), t[2]);
    return {halfWay(low.x, high.x), halfWay(low.y, high.y), halfWay(low.z, high.z)};
}

}  // namespace

// Triangles [begin, end), to become a node.
struct Surface::Part {
    std::uint32_t node, begin, end;
    int depth;
};

Surface::Surface(std::vector<FixedTriangle> triangles) : triangles_(std::move(triangles)) {
    CHECK_OP(triangles_.size(), >, 0u);
    CHECK_OP(triangles_.size(), <, std::numeric_limits<std::uint32_t>::max() / 2);
    nodes_.reserve(triangles_.size());
    nodes_.resize(1);
    std::vector<Part> todo{{0, 0, static_cast<std::uint32_t>(triangles_.size()), 0}};
    while (!todo.empty()) {
        const Part part = todo.back();
        todo.pop_back();
        const std::uint32_t middle = finishNode(part);
        if (middle == part.end) continue;
        const std::uint32_t children = nodes_[part.node].first;
        todo.push_back({children, part.begin, middle, part.depth + 1});
        todo.push_back({children + 1, middle, part.end, part.depth + 1});
    }
}

// Makes a leaf and returns part.end, or makes room for two children and returns where the second begins.
std::uint32_t Surface::finishNode(const Part& part) {
    Node node{triangles_[part.begin][0], triangles_[part.begin][0], part.begin, part.end - part.begin};
    for (std::uint32_t i = part.begin; i < part.end; ++i) {
        for (const Corner& corner : triangles_[i])
            node.min = glm::min(node.min, corner), node.max = glm::max(node.max, corner);
    }
    std::uint32_t middle = part.end;
    if (node.count > kLeafTriangles) {
        middle = split(part);
        node.count = 0;
        node.first = static_cast<std::uint32_t>(nodes_.size());
        nodes_.resize(nodes_.size() + 2);
    }
    nodes_[part.node] = node;
    return middle;
}

// In the middle of the centres' longest extent; in halves where the centres are all one, or deep down.
std::uint32_t Surface::split(const Part& part) {
    const auto begin = triangles_.begin() + part.begin, end = triangles_.begin() + part.end;
    Corner low = middleOf(*begin), high = low;
    for (auto triangle = begin; triangle != end; ++triangle) {
        const Corner middle = middleOf(*triangle);
        low = glm::min(low, middle), high = glm::max(high, middle);
    }
    const glm::dvec3 size = toDouble(high) - toDouble(low);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    auto cut = begin + (end - begin) / 2;
    if (high[axis] > low[axis] && part.depth < kMiddleDepth) {
        const std::int32_t plane = halfWay(low[axis], high[axis]);
        cut = std::partition(begin, end, [&](const FixedTriangle& t) { return middleOf(t)[axis] <= plane; });
    } else {
        std::nth_element(begin, cut, end, [&](const FixedTriangle& a, const FixedTriangle& b) {
            return middleOf(a)[axis] < middleOf(b)[axis];
        });
    }
    return static_cast<std::uint32_t>(cut - triangles_.begin());
}

double Surface::toBox(const glm::dvec3& point, const Node& node) {
    const glm::dvec3 d =
        glm::max(glm::max(toDouble(node.min) - point, point - toDouble(node.max)), glm::dvec3(0));
    return glm::dot(d, d);
}

double Surface::distance(const glm::dvec3& point) const {
    struct Visit {
        std::uint32_t node;
        double squaredDistance;
    };
    std::array<Visit, kMaxDepth + 1> stack;
    std::size_t size = 0;
    double best = std::numeric_limits<double>::infinity();
    stack[size++] = {0, 0};
    while (size > 0) {
        const Visit visit = stack[--size];
        if (visit.squaredDistance >= best) continue;
        const Node& node = nodes_[visit.node];
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
            best = std::min(best, squaredDistance(point, triangles_[i]));
        if (node.count > 0) continue;
        Visit near{node.first, toBox(point, nodes_[node.first])};
        Visit far{node.first + 1, toBox(point, nodes_[node.first + 1])};
        if (far.squaredDistance < near.squaredDistance) std::swap(near, far);
        if (far.squaredDistance < best) stack[size++] = far;
        if (near.squaredDistance < best) stack[size++] = near;
    }
    return std::sqrt(best);
}

}  // namespace iwalk::levels
