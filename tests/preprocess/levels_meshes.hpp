#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <set>
#include <vector>

#include "preprocess/levels/collapse.hpp"

// Meshes for collapse(), and what it makes of them.
namespace iwalk {

using Triple = std::array<std::uint32_t, 3>;

// A mesh of these, with no errors and no point held. `colors`: of the triangles, or none.
CollapseMesh makeMesh(std::vector<glm::vec3> points, std::vector<Triple> triangles,
                      const std::vector<std::uint32_t>& colors = {});

// `columns` by `rows` squares of two triangles each, between points at(column, row).
CollapseMesh gridMesh(std::uint32_t columns, std::uint32_t rows,
                      const std::function<glm::vec3(std::uint32_t, std::uint32_t)>& at,
                      const std::function<std::uint32_t(std::uint32_t column)>& colorOf = {});

// Both beside one another.
CollapseMesh joined(const CollapseMesh& a, const CollapseMesh& b);

// Equal points become one.
CollapseMesh welded(const CollapseMesh& mesh);

// The map, applied to the mesh that it was made for.
struct Collapsed {
    Collapsed(const CollapseMesh& before, const CollapseLimits& limits);

    CollapseMesh mesh;  // before
    CollapseMap map;
    std::vector<std::size_t> kept;                 // triangles of three different points, by number
    std::vector<Triple> triangles;                 // where their corners are now
    std::set<std::array<std::uint32_t, 2>> lines;  // of triangles with two different points, ascending
    std::set<std::array<std::uint32_t, 2>> edges;  // of triangles kept, ascending
    std::set<std::uint32_t> points;                // that triangles kept use

    float longestEdge() const;
    // Of triangles kept; of the colour only, when one is given and all their corners have it.
    float area() const;
    float area(std::uint32_t color) const;
    bool isColor(std::size_t i, std::uint32_t color) const;  // all corners of triangles[i]
};

}  // namespace iwalk
