#include "tests/preprocess/levels_meshes.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>

namespace iwalk {
namespace {

std::array<std::uint32_t, 2> ascending(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

float areaOf(const CollapseMesh& mesh, const Triple& t) {
    const glm::vec3 a = mesh.points[t[0]];
    return 0.5f * glm::length(glm::cross(mesh.points[t[1]] - a, mesh.points[t[2]] - a));
}

}  // namespace

CollapseMesh makeMesh(std::vector<glm::vec3> points, std::vector<Triple> triangles,
                      const std::vector<std::uint32_t>& colors) {
    CollapseMesh mesh;
    mesh.errors.assign(points.size(), 0);
    mesh.held.assign(points.size(), 0);
    mesh.points = std::move(points);
    mesh.triangles = std::move(triangles);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> wedges;  // of point and colour
    for (std::size_t t = 0; t < colors.size(); ++t) {
        Triple& corners = mesh.wedges.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            const auto next = static_cast<std::uint32_t>(mesh.wedgeColors.size());
            const auto [wedge, isNew] = wedges.try_emplace({mesh.triangles[t][c], colors[t]}, next);
            if (isNew) mesh.wedgeColors.push_back(colors[t]);
            corners[c] = wedge->second;
        }
    }
    return mesh;
}

CollapseMesh gridMesh(std::uint32_t columns, std::uint32_t rows,
                      const std::function<glm::vec3(std::uint32_t, std::uint32_t)>& at,
                      const std::function<std::uint32_t(std::uint32_t column)>& colorOf) {
    std::vector<glm::vec3> points;
    std::vector<Triple> triangles;
    std::vector<std::uint32_t> colors;
    for (std::uint32_t row = 0; row <= rows; ++row) {
        for (std::uint32_t column = 0; column <= columns; ++column) {
            const auto p = static_cast<std::uint32_t>(points.size());
            points.push_back(at(column, row));
            if (row == rows || column == columns) continue;
            triangles.push_back({p, p + 1, p + columns + 2});
            triangles.push_back({p, p + columns + 2, p + columns + 1});
            if (colorOf) colors.insert(colors.end(), 2, colorOf(column));
        }
    }
    return makeMesh(std::move(points), std::move(triangles), colors);
}

CollapseMesh joined(const CollapseMesh& a, const CollapseMesh& b) {
    CollapseMesh mesh = a;
    const auto first = static_cast<std::uint32_t>(a.points.size());
    mesh.points.insert(mesh.points.end(), b.points.begin(), b.points.end());
    mesh.errors.insert(mesh.errors.end(), b.errors.begin(), b.errors.end());
    mesh.held.insert(mesh.held.end(), b.held.begin(), b.held.end());
    for (const Triple& t : b.triangles) {
        mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return mesh;
}

CollapseMesh welded(const CollapseMesh& mesh) {
    std::map<std::tuple<float, float, float>, std::uint32_t> numbers;
    std::vector<glm::vec3> points;
    std::vector<Triple> triangles;
    for (const Triple& t : mesh.triangles) {
        Triple& corners = triangles.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            const glm::vec3& p = mesh.points[t[c]];
            const auto next = static_cast<std::uint32_t>(points.size());
            const auto [number, isNew] = numbers.try_emplace({p.x, p.y, p.z}, next);
            if (isNew) points.push_back(p);
            corners[c] = number->second;
        }
    }
    return makeMesh(std::move(points), std::move(triangles));
}

Collapsed::Collapsed(const CollapseMesh& before, const CollapseLimits& limits) : mesh(before) {
    CollapseMesh used = before;
    map = collapse(used, limits);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        Triple t = mesh.triangles[i];
        for (std::uint32_t& point : t) point = map.points[point];
        const std::set<std::uint32_t> different(t.begin(), t.end());
        if (different.size() == 2) lines.insert(ascending(*different.begin(), *different.rbegin()));
        if (different.size() < 3) continue;
        kept.push_back(i);
        triangles.push_back(t);
        points.insert(t.begin(), t.end());
        for (std::size_t c = 0; c < 3; ++c) edges.insert(ascending(t[c], t[(c + 1) % 3]));
    }
}

float Collapsed::longestEdge() const {
    float longest = 0;
    for (const auto& [a, b] : edges)
        longest = std::max(longest, glm::distance(mesh.points[a], mesh.points[b]));
    return longest;
}

float Collapsed::area() const {
    float sum = 0;
    for (const Triple& t : triangles) sum += areaOf(mesh, t);
    return sum;
}

float Collapsed::area(std::uint32_t color) const {
    float sum = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        sum += isColor(i, color) ? areaOf(mesh, triangles[i]) : 0;
    return sum;
}

bool Collapsed::isColor(std::size_t i, std::uint32_t color) const {
    return std::ranges::all_of(mesh.wedges[kept[i]], [&](std::uint32_t wedge) {
        return mesh.wedgeColors[map.wedges[wedge]] == color;
    });
}

}  // namespace iwalk
