#include "tests/tools/scenes.hpp"

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>

#include "common/check.hpp"
#include "common/file.hpp"

namespace iwalk::tools {
namespace {

using Corners = std::array<glm::dvec3, 8>;  // bit 0, 1, 2 of the index: max in x, y, z

Corners cornersOf(const glm::dvec3& min, const glm::dvec3& max) {
    Corners corners;
    for (std::size_t i = 0; i < 8; ++i) {
        corners[i] = {(i & 1 ? max : min).x, (i & 2 ? max : min).y, (i & 4 ? max : min).z};
    }
    return corners;
}

void addQuad(Triangles& out, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
             const glm::dvec3& d) {
    out.push_back({a, b, c});
    out.push_back({a, c, d});
}

// All sides but the one at max.z.
Triangles openBox(const Corners& c) {
    Triangles out;
    addQuad(out, c[0], c[2], c[3], c[1]);  // min z
    addQuad(out, c[0], c[1], c[5], c[4]);  // min y
    addQuad(out, c[2], c[6], c[7], c[3]);  // max y
    addQuad(out, c[0], c[4], c[6], c[2]);  // min x
    addQuad(out, c[1], c[3], c[7], c[5]);  // max x
    return out;
}

Triangles icosahedron() {
    const double g = (1 + std::sqrt(5.0)) / 2;  // the golden ratio
    const std::array<glm::dvec3, 12> p{{{-1, g, 0},
                                        {1, g, 0},
                                        {-1, -g, 0},
                                        {1, -g, 0},
                                        {0, -1, g},
                                        {0, 1, g},
                                        {0, -1, -g},
                                        {0, 1, -g},
                                        {g, 0, -1},
                                        {g, 0, 1},
                                        {-g, 0, -1},
                                        {-g, 0, 1}}};
    constexpr std::size_t kFaces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                           {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                           {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                           {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    Triangles out;
    for (const auto& face : kFaces) out.push_back({p[face[0]], p[face[1]], p[face[2]]});
    return out;
}

Triangles subdivided(const Triangles& triangles) {
    Triangles out;
    for (const auto& [a, b, c] : triangles) {
        // Addition commutes, so both triangles of an edge make the same point.
        const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
        out.insert(out.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return out;
}

template <class T>
void append(std::string& out, const T& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void appendPosition(std::string& out, const glm::dvec3& position, bool doubles) {
    if (doubles) {
        append(out, position);
    } else {
        append(out, glm::vec3(position));
    }
}

std::string plyHeader(std::size_t vertices, std::size_t faces, const PlyOptions& options) {
    const char* type = options.doubles ? "double" : "float";
    std::string header = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", vertices);
    for (const char* axis : {"x", "y", "z"}) header += fmt::format("property {} {}\n", type, axis);
    if (!options.colors.empty()) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    return header +
           fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", faces);
}

}  // namespace

Triangles sphere(double radius, int subdivisions) {
    Triangles triangles = icosahedron();
    for (Triangle& triangle : triangles) {
        for (glm::dvec3& corner : triangle) corner = glm::normalize(corner);
    }
    for (int i = 0; i < subdivisions; ++i) triangles = subdivided(triangles);
    for (Triangle& triangle : triangles) {
        for (glm::dvec3& corner : triangle) corner *= radius;
    }
    return triangles;
}

Triangles box(const glm::dvec3& min, const glm::dvec3& max) {
    const Corners c = cornersOf(min, max);
    Triangles out = openBox(c);
    addQuad(out, c[4], c[5], c[7], c[6]);
    return out;
}

Triangles boxWithWindow(const glm::dvec3& min, const glm::dvec3& max, const glm::dvec2& windowMin,
                        const glm::dvec2& windowMax) {
    CHECK(min.x < windowMin.x && windowMin.x < windowMax.x && windowMax.x < max.x);
    CHECK(min.y < windowMin.y && windowMin.y < windowMax.y && windowMax.y < max.y);
    const Corners c = cornersOf(min, max);
    const Corners w = cornersOf({windowMin, max.z}, {windowMax, max.z});
    Triangles out = openBox(c);
    // A frame of four trapezia, from corner to corner: no corner lies on an edge.
    addQuad(out, c[4], c[5], w[5], w[4]);
    addQuad(out, c[5], c[7], w[7], w[5]);
    addQuad(out, c[7], c[6], w[6], w[7]);
    addQuad(out, c[6], c[4], w[4], w[6]);
    return out;
}

Triangles moved(Triangles triangles, const glm::dvec3& offset) {
    for (Triangle& triangle : triangles) {
        for (glm::dvec3& corner : triangle) corner += offset;
    }
    return triangles;
}

Result<void> writePly(const std::string& path, const Triangles& triangles, const PlyOptions& options) {
    const bool colored = !options.colors.empty();
    if (colored) CHECK_OP(options.colors.size(), ==, triangles.size());

    std::map<std::tuple<double, double, double, Color>, std::int32_t> known;
    std::string vertices, faces;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        append(faces, std::uint8_t{3});
        const Color color = colored ? options.colors[i] : Color{};
        for (const glm::dvec3& corner : triangles[i]) {
            const auto next = static_cast<std::int32_t>(known.size());
            const auto [vertex, isNew] = known.try_emplace({corner.x, corner.y, corner.z, color}, next);
            append(faces, vertex->second);
            if (!isNew) continue;
            appendPosition(vertices, corner, options.doubles);
            if (colored) append(vertices, color);
        }
    }
    return replaceFile(path, plyHeader(known.size(), triangles.size(), options) + vertices + faces);
}

}  // namespace iwalk::tools
