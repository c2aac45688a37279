#pragma once

#include <array>
#include <vector>

#include "common/geometry.hpp"

// A closed square tube along x in three resolutions, for tests: level 1 leaves out every other ring of the
// input, level 0 three of four. Positions are lattice steps from the root cell's lowest corner.
namespace iwalk::levels {

inline constexpr int kSegments = 248, kTubeLevels = 2, kInput = kTubeLevels;
inline constexpr std::int64_t kTubeStep = 16;
inline constexpr int kFirstStep = 1;  // so that rings between cells move at both levels

struct RingCorner {
    int ring, corner;
};
using TubeTriangle = std::array<RingCorner, 3>;

inline std::int64_t ringX(int ring) {
    return (ring + kFirstStep) * kTubeStep;
}

// Where a corner of a ring is at a level.
inline LatticePoint tubePoint(const RingCorner& corner, int level) {
    const int keep = 4 >> level;
    const int ring = corner.ring / keep * keep;
    const std::int64_t y = corner.corner == 1 || corner.corner == 2 ? 8 : 0, z = corner.corner >= 2 ? 8 : 0;
    return {ringX(ring), y, z + ring % 3};
}

// Those between two rings, and the tube's ends.
inline std::vector<TubeTriangle> tubeTriangles(int segment) {
    std::vector<TubeTriangle> triangles;
    for (int c = 0; c < 4; ++c) {
        const RingCorner a{segment, c}, b{segment, (c + 1) % 4};
        const RingCorner d{segment + 1, c}, e{segment + 1, (c + 1) % 4};
        triangles.push_back({a, b, e});
        triangles.push_back({a, e, d});
    }
    const auto addEnd = [&](int ring, int second, int third) {
        triangles.push_back({RingCorner{ring, 0}, RingCorner{ring, second}, RingCorner{ring, third}});
    };
    if (segment == 0) addEnd(0, 2, 1), addEnd(0, 3, 2);
    if (segment == kSegments - 1) addEnd(kSegments, 1, 2), addEnd(kSegments, 2, 3);
    return triangles;
}

// Whether two corners of a triangle are one at a level.
inline bool isGone(const TubeTriangle& t, int level) {
    const LatticePoint a = tubePoint(t[0], level), b = tubePoint(t[1], level), c = tubePoint(t[2], level);
    return a == b || b == c || c == a;
}

}  // namespace iwalk::levels
