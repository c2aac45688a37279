#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace iwalk {

// The corners of a cube are numbered by bits: 1 for x, 2 for y, 4 for z. Its edges: 0-3 along x, 4-7 along y,
// 8-11 along z; in each four the lowest corner's two other coordinates count, the lower axis first.
struct CubeEdge {
    std::uint8_t axis = 0;  // 0 x, 1 y, 2 z
    std::uint8_t from = 0;  // the corner it starts at; it ends at from + (1 << axis)
};
constexpr CubeEdge cubeEdge(unsigned edge) {
    const unsigned axis = edge / 4, low = edge & 1, high = edge >> 1 & 1;
    constexpr std::array<std::array<unsigned, 2>, 3> kOthers{{{1, 2}, {0, 2}, {0, 1}}};
    return {static_cast<std::uint8_t>(axis),
            static_cast<std::uint8_t>(low << kOthers[axis][0] | high << kOthers[axis][1])};
}

// For each set of inside corners, as bits, the triangles of the surface between inside and outside: three
// edges each, counter-clockwise seen from outside the surface.
using CubeTriangles = std::array<std::uint8_t, 3>;
struct CubeCase {
    std::vector<CubeTriangles> triangles;
    std::vector<std::uint8_t> edges;  // that the triangles have corners on, each once
};
using CubeTable = std::array<CubeCase, 256>;

CubeTable makeCubeTable();

}  // namespace iwalk
