#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "common/dataset/hierarchy.hpp"
#include "common/geometry.hpp"
#include "common/result.hpp"

namespace iwalk {

inline constexpr std::uint32_t kMaxPageVertices = 65535;
inline constexpr std::uint32_t kMaxPageIndices = 3 * kMaxPageVertices;
inline constexpr int kNarrowBits = 21;
inline constexpr std::uint32_t kPageHeaderBytes = 136;
inline constexpr std::uint32_t kMorphHeaderBytes = 104;
inline constexpr std::uint32_t kMaxPageBytes = std::uint32_t{8} << 20;  // on disk

// Cells below a node are named by the way down: 1, followed by 3 bits for each octant; 1 is the node's own
// cell. Cells of one depth are in Morton order.
inline constexpr unsigned kMaxPathLevels = 10;
inline constexpr std::uint32_t kRootPath = 1;

// The unit of culling and drawing: a contiguous part of a page's indices, and a box that contains its
// triangles and those of the same cell in all finer levels.
struct Range {
    std::uint32_t firstIndex, indexCount;  // multiples of 3
    std::uint32_t path;                    // the cell below the node's that its triangles belong to
    std::uint32_t boxMin[3], boxMax[3];    // lattice steps from the page's origin, inclusive
};
static_assert(sizeof(Range) == 36);

// Levels below the node's cell.
inline unsigned pathLevels(std::uint32_t path) {
    return static_cast<unsigned>(std::bit_width(path) - 1) / 3;
}
inline bool isPath(std::uint32_t path) {
    return path != 0 && std::bit_width(path) % 3 == 1 && pathLevels(path) <= kMaxPathLevels;
}
// Whether the cell `inner` is `outer` or a part of it.
inline bool pathContains(std::uint32_t outer, std::uint32_t inner) {
    return pathLevels(inner) >= pathLevels(outer) &&
           inner >> 3 * (pathLevels(inner) - pathLevels(outer)) == outer;
}

// A vertex of a page while it is built. Attributes that the page does not have are 0.
struct PageVertex {
    std::uint32_t offset[3];  // lattice steps from the page's origin
    std::uint32_t color;      // RGBA8 in memory order, sRGB
    std::uint32_t normal;     // packNormal()
    bool operator==(const PageVertex&) const = default;
};

// A page's geometry while it is built.
struct PageGeometry {
    LatticePoint origin{0, 0, 0};  // lattice: the lowest corner of all ranges' boxes
    std::uint32_t attributes = 0;  // kPageColors | kPageNormals
    std::vector<PageVertex> vertices;
    std::vector<std::uint16_t> indices;
    std::vector<Range> ranges;  // complete, in index order, covering all indices
};

// Encodes a page for disk and fills `record` but for its place in a file; it has no morph block until
// encodeMorph(). Wide only when a vertex needs it. Ranges that do not contain their triangles are the
// caller's bug.
std::vector<std::byte> encodePage(const PageGeometry& page, PageRecord& record);

// Where the streams of a decoded page lie: byte offsets from its start, each a multiple of 4 (positions 8).
struct PageLayout {
    std::uint32_t positions, colors, normals, indices;  // colors, normals: meaningful only with their flag
    std::uint32_t bytes;                                // the whole, rounded up to a multiple of 256
    std::uint32_t positionStride;                       // 8 or 12 bytes
};
PageLayout pageLayout(const PageRecord& record);

// Counts, flags and size that a page can have; loadHierarchy() has asked this of all of its records.
Result<void> checkPageRecord(const PageRecord& record);

// What stays beside a decoded page.
struct PageTable {
    LatticePoint origin{0, 0, 0};
    std::vector<Range> ranges;
};

// Decodes the page that `record` describes from its bytes on disk into `out` (pageLayout(record).bytes long,
// which may be memory mapped from a GPU: it is written once, in order, padding left alone). Checks every
// checksum and every index. Errors say what is wrong where in the page; the caller knows its file and offset.
Result<PageTable> decodePage(std::span<const std::byte> bytes, const PageRecord& record,
                             std::span<std::byte> out);

// Lattice steps from the page's origin of vertex `index` of a decoded page.
glm::u32vec3 pageOffset(std::span<const std::byte> decoded, const PageRecord& record, std::uint32_t index);
// Of all of its vertices, lattice.
std::vector<LatticePoint> latticePositions(const PageTable& table, std::span<const std::byte> decoded,
                                           const PageRecord& record);

// Unit normals as octahedral 2 x snorm16 (x in the low half); at most 0.005 degrees off.
std::uint32_t packNormal(const glm::vec3& unit);
glm::vec3 unpackNormal(std::uint32_t packed);

}  // namespace iwalk
