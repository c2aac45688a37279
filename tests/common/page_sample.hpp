#pragma once

#include <random>

#include "common/dataset/page.hpp"

namespace iwalk {

// A strip of triangles in two ranges; offsets below 2^bits.
inline PageGeometry makePage(std::uint32_t triangles, int bits, std::uint32_t attributes) {
    std::mt19937 random(7);
    PageGeometry page;
    page.origin = LatticePoint(-5, std::int64_t{1} << 40, 17);
    page.attributes = attributes;
    const std::uint32_t mask = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
    for (std::uint32_t v = 0; v < triangles + 2; ++v) {
        PageVertex vertex{};
        for (std::uint32_t& axis : vertex.offset) axis = static_cast<std::uint32_t>(random()) & mask;
        if ((attributes & kPageColors) != 0) vertex.color = static_cast<std::uint32_t>(random());
        if ((attributes & kPageNormals) != 0) vertex.normal = static_cast<std::uint32_t>(random());
        page.vertices.push_back(vertex);
    }
    page.vertices[0].offset[2] = mask;
    for (std::uint32_t i = 0; i < 3 * triangles; ++i)
        page.indices.push_back(static_cast<std::uint16_t>(i / 3 + i % 3));
    const std::uint32_t half = triangles / 2 * 3;
    page.ranges.push_back({0, half, 0b1011, {0, 0, 0}, {mask, mask, mask}});
    page.ranges.push_back({half, 3 * triangles - half, 0b1110, {0, 0, 0}, {mask, mask, mask}});
    return page;
}

}  // namespace iwalk
