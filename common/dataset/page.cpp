// Pages on disk and in memory; docs/format.md has every byte. Streams are coded with meshoptimizer's vertex
// and index codecs, which promise to stay in bounds on any input; whatever they do not promise is checked
// here.
#include "common/dataset/page.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "common/dataset/page_ranges.hpp"
#include "common/dataset/page_streams.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kPageMagic = 0x47505749;  // "IWPG"
constexpr std::uint32_t kMaxOffset = std::numeric_limits<std::uint32_t>::max();

enum Stream { kRanges, kPositions, kColors, kNormals, kIndices, kStreams };
constexpr std::array<const char*, kStreams> kStreamNames{"page ranges", "page positions", "page colors",
                                                         "page normals", "page indices"};

struct PageHeader {
    std::uint32_t magic, version, flags, vertexCount, indexCount, rangeCount;
    std::int64_t origin[3];
    StreamRecord streams[kStreams];
    std::uint64_t hash;  // xxh64 of everything before
};
static_assert(sizeof(PageHeader) == kPageHeaderBytes);

std::uint64_t headerHash(const PageHeader& header) {
    return hashOf(std::as_bytes(std::span(&header, 1)).first(offsetof(PageHeader, hash)));
}

std::vector<std::byte> codeMember(const std::vector<PageVertex>& vertices,
                                  std::uint32_t PageVertex::*member) {
    std::vector<std::uint32_t> values;
    values.reserve(vertices.size());
    for (const PageVertex& vertex : vertices) values.push_back(vertex.*member);
    return codeItems(values);
}

// The codec's version 1 is a little smaller; meshoptimizer has one setting for the whole program.
void chooseIndexCodec() {
    static const bool chosen = (meshopt_encodeIndexVersion(1), true);
    static_cast<void>(chosen);
}

std::vector<std::byte> codeIndices(const std::vector<std::uint16_t>& indices, std::size_t vertexCount) {
    chooseIndexCodec();
    const std::vector<unsigned> wide(indices.begin(), indices.end());
    std::vector<std::byte> coded(meshopt_encodeIndexBufferBound(wide.size(), vertexCount));
    coded.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(coded.data()), coded.size(),
                                           wide.data(), wide.size()));
    return coded;
}

std::vector<PageOffset> offsetsOf(const std::vector<PageVertex>& vertices) {
    std::vector<PageOffset> offsets;
    offsets.reserve(vertices.size());
    for (const PageVertex& vertex : vertices) offsets.push_back(std::to_array(vertex.offset));
    return offsets;
}

void checkRangeGeometry(const PageGeometry& page) {
    PageOffset lowest{kMaxOffset, kMaxOffset, kMaxOffset};
    for (const Range& range : page.ranges) {
        CHECK(isPath(range.path));
        const auto indices = std::span(page.indices).subspan(range.firstIndex, range.indexCount);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lowest[axis] = std::min(lowest[axis], range.boxMin[axis]);
            for (const std::uint16_t index : indices) {
                CHECK_OP(index, <, page.vertices.size());
                const std::uint32_t at = page.vertices[index].offset[axis];
                CHECK_OP(at, >=, range.boxMin[axis]);
                CHECK_OP(at, <=, range.boxMax[axis]);
            }
        }
    }
    CHECK((lowest == PageOffset{0, 0, 0}));
}

bool hasStream(std::uint32_t flags, int stream) {
    if (stream == kColors) return (flags & kPageColors) != 0;
    if (stream == kNormals) return (flags & kPageNormals) != 0;
    return true;
}

Result<void> checkHeader(std::span<const std::byte> bytes, const PageRecord& record, PageHeader& header) {
    if (bytes.size() != record.bytes || bytes.size() < sizeof(header)) {
        return fail("page of {} bytes where its record says {}", bytes.size(), record.bytes);
    }
    std::memcpy(&header, bytes.data(), sizeof(header));
    if (header.magic != kPageMagic) return fail("page header: no page begins here");
    if (header.version != kDatasetVersion) {
        return fail("page header: version {}, but this program reads version {}", header.version,
                    kDatasetVersion);
    }
    if (header.hash != headerHash(header)) return fail("page header: checksum does not match");
    if (header.flags != (record.flags & ~std::uint32_t{kMorphWide}) ||
        header.vertexCount != record.vertexCount || header.indexCount != record.indexCount ||
        header.rangeCount != record.rangeCount) {
        return fail("page header: flags or counts are not those of its record");
    }
    for (const std::int64_t axis : header.origin) {
        if (axis < -kLatticeLimit || axis > kLatticeLimit) return fail("page header: origin out of bounds");
    }
    return checkPageRecord(record);
}

// Streams lie one behind the other and fill the page, so that no byte of it goes unchecked.
Result<void> checkStreams(std::span<const std::byte> bytes, const PageHeader& header) {
    std::size_t place = sizeof(PageHeader);
    for (int s = 0; s < kStreams; ++s) {
        const StreamRecord& stream = header.streams[s];
        const char* const name = kStreamNames[static_cast<std::size_t>(s)];
        if (!hasStream(header.flags, s)) {
            const bool blank = stream.offset == 0 && stream.bytes == 0 && stream.hash == 0;
            if (!blank) return fail("page header: {} where the flags say there are none", name);
            continue;
        }
        RETURN_IF_ERROR(checkStream(bytes, stream, name, place));
    }
    if (place != bytes.size()) return fail("page: {} bytes behind its last stream", bytes.size() - place);
    return {};
}

// Indices are decoded beside `out` and checked there, as `out` may be slow to read.
Result<void> decodeIndices(std::span<const std::byte> coded, const PageRecord& record, std::byte* out) {
    std::vector<std::uint16_t> indices(record.indexCount);
    if (meshopt_decodeIndexBuffer(indices.data(), indices.size(), sizeof(std::uint16_t),
                                  reinterpret_cast<const unsigned char*>(coded.data()), coded.size()) != 0) {
        return fail("page indices: cannot be decoded");
    }
    std::uint16_t highest = 0;
    for (const std::uint16_t index : indices) highest = std::max(highest, index);
    if (highest >= record.vertexCount) {
        return fail("page indices: vertex {} of {}", highest, record.vertexCount);
    }
    std::memcpy(out, indices.data(), indices.size() * sizeof(std::uint16_t));
    return {};
}

std::uint32_t alignUp(std::uint32_t value, std::uint32_t to) {
    return (value + to - 1) / to * to;
}

}  // namespace

Result<void> checkPageRecord(const PageRecord& record) {
    const bool page = (record.flags & ~(kPageWide | kPageColors | kPageNormals | kMorphWide)) == 0 &&
                      record.vertexCount >= 1 && record.vertexCount <= kMaxPageVertices &&
                      record.indexCount >= 3 && record.indexCount % 3 == 0 &&
                      record.indexCount <= kMaxPageIndices && record.rangeCount >= 1 &&
                      record.rangeCount <= record.indexCount / 3 && record.bytes >= kPageHeaderBytes &&
                      record.bytes <= kMaxPageBytes && record.reserved == 0;
    if (!page) {
        return fail("page record: impossible: {} bytes, {} vertices, {} indices, {} ranges, flags {}",
                    record.bytes, record.vertexCount, record.indexCount, record.rangeCount, record.flags);
    }
    const bool blank = record.morphOffset == 0 && record.morphFile == 0 && (record.flags & kMorphWide) == 0;
    const bool morph = record.morphBytes == 0
                           ? blank
                           : record.morphBytes >= kMorphHeaderBytes && record.morphBytes <= kMaxPageBytes;
    if (morph) return {};
    return fail("page record: impossible morph block of {} bytes", record.morphBytes);
}

std::vector<std::byte> encodePage(const PageGeometry& page, PageRecord& record) {
    CHECK_OP(page.vertices.size(), <=, kMaxPageVertices);
    CHECK_OP(page.indices.size(), <=, kMaxPageIndices);
    checkRangeGeometry(page);
    const std::vector<PageOffset> offsets = offsetsOf(page.vertices);
    PageHeader header{};
    header.magic = kPageMagic;
    header.version = kDatasetVersion;
    header.flags = page.attributes | (needsWide(offsets) ? kPageWide : 0u);
    header.vertexCount = static_cast<std::uint32_t>(page.vertices.size());
    header.indexCount = static_cast<std::uint32_t>(page.indices.size());
    header.rangeCount = static_cast<std::uint32_t>(page.ranges.size());
    for (glm::length_t axis = 0; axis < 3; ++axis) header.origin[axis] = page.origin[axis];

    std::vector<std::byte> bytes(sizeof(header));
    const auto append = [&](Stream stream, std::span<const std::byte> coded) {
        header.streams[stream] = appendStream(bytes, coded);
    };
    append(kRanges, codeRanges(page.ranges));
    append(kPositions, codePositions(offsets, (header.flags & kPageWide) != 0));
    if ((header.flags & kPageColors) != 0) append(kColors, codeMember(page.vertices, &PageVertex::color));
    if ((header.flags & kPageNormals) != 0) append(kNormals, codeMember(page.vertices, &PageVertex::normal));
    append(kIndices, codeIndices(page.indices, page.vertices.size()));
    header.hash = headerHash(header);
    std::memcpy(bytes.data(), &header, sizeof(header));

    record.bytes = static_cast<std::uint32_t>(bytes.size());
    record.vertexCount = header.vertexCount;
    record.indexCount = header.indexCount;
    record.rangeCount = header.rangeCount;
    record.flags = header.flags;
    record.morphOffset = record.morphBytes = record.morphFile = 0;
    record.reserved = 0;
    CHECK_OP(checkPageRecord(record).ok(), ==, true);
    return bytes;
}

PageLayout pageLayout(const PageRecord& record) {
    PageLayout layout{};
    layout.positionStride = (record.flags & kPageWide) != 0 ? 12 : 8;
    layout.colors = alignUp(layout.positionStride * record.vertexCount, 8);
    layout.normals =
        layout.colors + ((record.flags & kPageColors) != 0 ? alignUp(4 * record.vertexCount, 8) : 0);
    layout.indices =
        layout.normals + ((record.flags & kPageNormals) != 0 ? alignUp(4 * record.vertexCount, 8) : 0);
    layout.bytes = alignUp(layout.indices + 2 * record.indexCount, 256);
    return layout;
}

Result<PageTable> decodePage(std::span<const std::byte> bytes, const PageRecord& record,
                             std::span<std::byte> out) {
    PageHeader header{};
    RETURN_IF_ERROR(checkHeader(bytes, record, header));
    RETURN_IF_ERROR(checkStreams(bytes, header));
    const PageLayout layout = pageLayout(record);
    CHECK_OP(out.size(), ==, layout.bytes);

    const auto stream = [&](Stream s) {
        return bytes.subspan(header.streams[s].offset, header.streams[s].bytes);
    };
    const auto vertices = [&](Stream s, std::uint32_t place, std::uint32_t stride) {
        return decodeItems(stream(s), kStreamNames[s], record.vertexCount, stride, out.data() + place);
    };
    ASSIGN_OR_RETURN(std::vector<Range> ranges, decodeRanges(stream(kRanges), record));
    RETURN_IF_ERROR(vertices(kPositions, layout.positions, layout.positionStride));
    if ((record.flags & kPageColors) != 0) RETURN_IF_ERROR(vertices(kColors, layout.colors, 4));
    if ((record.flags & kPageNormals) != 0) RETURN_IF_ERROR(vertices(kNormals, layout.normals, 4));
    RETURN_IF_ERROR(decodeIndices(stream(kIndices), record, out.data() + layout.indices));
    return PageTable{LatticePoint(header.origin[0], header.origin[1], header.origin[2]), std::move(ranges)};
}

glm::u32vec3 pageOffset(std::span<const std::byte> decoded, const PageRecord& record, std::uint32_t index) {
    const PageLayout layout = pageLayout(record);
    return unpackPosition(decoded.data() + layout.positions + std::size_t{index} * layout.positionStride,
                          (record.flags & kPageWide) != 0);
}

std::vector<LatticePoint> latticePositions(const PageTable& table, std::span<const std::byte> decoded,
                                           const PageRecord& record) {
    std::vector<LatticePoint> positions;
    positions.reserve(record.vertexCount);
    for (std::uint32_t v = 0; v < record.vertexCount; ++v) {
        positions.push_back(table.origin + LatticePoint(pageOffset(decoded, record, v)));
    }
    return positions;
}

}  // namespace iwalk
