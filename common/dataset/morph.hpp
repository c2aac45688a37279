#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/dataset/page.hpp"

// Morph blocks: where the vertices of a page go on the way to the next coarser level. They lie apart from
// their pages, since they are read only where levels blend.
namespace iwalk {

// Lattice steps from the morph block's origin, inclusive.
struct MorphBox {
    std::uint32_t min[3], max[3];
    bool operator==(const MorphBox&) const = default;
};
static_assert(sizeof(MorphBox) == 24);

// As a shader reads it: a vertex goes where the vertex of its number is, or, from vertexCount on, to the
// extra position (number - vertexCount).
struct PageMorph {
    LatticePoint origin{0, 0, 0};        // lattice: the lowest target in each axis
    std::vector<std::uint32_t> numbers;  // by vertex of the page; all name something
    std::vector<glm::u32vec3> extras;    // steps from the origin; none or a few: most go to another vertex
    std::vector<MorphBox> boxes;         // by range of the page: around the targets of its vertices
};

// A page that is on its way.
struct MorphSource {
    LatticePoint origin;                               // of the page, lattice
    std::span<const LatticePoint> positions, targets;  // of its vertices, lattice
    std::span<const Range> ranges;
    std::span<const std::uint16_t> indices;
};

// Encodes the morph block of a page that encodePage() has made: `record` says what the page has; its
// morphBytes and kMorphWide are set.
std::vector<std::byte> encodeMorph(const MorphSource& page, PageRecord& record);

// Decodes the morph block of the page that `record` describes and decodePage() gave `table` for; checks every
// checksum and every number.
Result<PageMorph> decodeMorph(std::span<const std::byte> bytes, const PageRecord& record,
                              const PageTable& table);

// Lattice: where the page's vertices go, which are at `positions`.
std::vector<LatticePoint> targetsOf(const PageMorph& morph, std::span<const LatticePoint> positions);

}  // namespace iwalk
