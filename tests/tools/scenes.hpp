#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "tests/tools/bvh.hpp"

// Small models whose answers are known. Triangles are counter-clockwise seen from outside; corners that
// neighbours share are equal to the last bit, and no corner lies on another triangle's edge.
namespace iwalk::tools {

using Triangles = std::vector<Triangle>;

// A closed icosphere about the origin: 20 * 4^subdivisions triangles with corners at `radius`.
Triangles sphere(double radius, int subdivisions);

// Closed, 12 triangles.
Triangles box(const glm::dvec3& min, const glm::dvec3& max);

// The same with a rectangular hole in its side at max.z: 18 triangles. The window is given by its corners in
// x and y, strictly inside the side.
Triangles boxWithWindow(const glm::dvec3& min, const glm::dvec3& max, const glm::dvec2& windowMin,
                        const glm::dvec2& windowMax);

// Every corner moved.
Triangles moved(Triangles triangles, const glm::dvec3& offset);

using Color = std::array<std::uint8_t, 3>;  // red, green, blue; sRGB

struct PlyOptions {
    std::vector<Color> colors;  // one for each triangle, written as colours of its own vertices; or none
    bool doubles = false;       // positions as double; otherwise float
};

// A binary little-endian PLY file. Equal corners (of one colour) are one vertex.
Result<void> writePly(const std::string& path, const Triangles& triangles, const PlyOptions& options = {});

}  // namespace iwalk::tools
