// Pages on disk and in memory; docs/format.md has every byte. Streams are coded with meshoptimizer's vertex
// and index codecs, which promise to stay in bounds on any input; whatever they do not promise is checked
// here.
#include "common/dataset/page.hpp"

#include <meshoptimizer.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

namespace iwalk {
namespace {

constexpr std::uint32_t kPageMagic = 0x47505749;  // "IWPG"
constexpr std::uint32_t kNarrowMask = (1u << kNarrowBits) - 1;

enum Stream { kRanges, kPositions, kColors, kNormals, kIndices, kStreams };
constexpr std::array<const char*, kStreams> kStreamNames{"ranges", "positions", "colors", "normals",
                                                         "indices"};

struct StreamRecord {
    std::uint32_t offset, bytes;  // from the page's start; both 0 when the page does not have the stream
    std::uint64_t hash;           // xxh64 of the stream
};

struct PageHeader {
    std::uint32_t magic, version, flags, vertexCount, indexCount, rangeCount;
    std::int64_t origin[3];
    StreamRecord streams[kStreams];
    std::uint64_t hash;  // xxh64 of everything before
};
static_assert(sizeof(PageHeader) == kPageHeaderBytes);

std::uint64_t hashOf(std::span<const std::byte> bytes) {
    return XXH64(bytes.data(), bytes.size(), 0);
}

std::uint64_t headerHash(const PageHeader& header) {
    return hashOf(std::as_bytes(std::span(&header, 1)).first(offsetof(PageHeader, hash)));
}

std::uint64_t packNarrow(const std::uint32_t (&offset)[3]) {
    return std::uint64_t{offset[0]} | std::uint64_t{offset[1]} << kNarrowBits |
           std::uint64_t{offset[2]} << (2 * kNarrowBits);
}

// Appends a stream behind what is there and notes it in the header.
void append(std::vector<std::byte>& bytes, PageHeader& header, Stream stream,
            std::span<const std::byte> coded) {
    header.streams[stream] = {static_cast<std::uint32_t>(bytes.size()),
                              static_cast<std::uint32_t>(coded.size()), hashOf(coded)};
    bytes.insert(bytes.end(), coded.begin(), coded.end());
}

template <class T>
std::vector<std::byte> codeVertices(const std::vector<T>& values) {
    std::vector<std::byte> coded(meshopt_encodeVertexBufferBound(values.size(), sizeof(T)));
    coded.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(coded.data()), coded.size(),
                                            values.data(), values.size(), sizeof(T)));
    return coded;
}

// One member of all vertices, packed by `pack`.
template <class Pack>
std::vector<std::byte> codeMember(const std::vector<PageVertex>& vertices, Pack pack) {
    std::vector<decltype(pack(vertices[0]))> values;
    values.reserve(vertices.size());
    for (const PageVertex& vertex : vertices) values.push_back(pack(vertex));
    return codeVertices(values);
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

bool isWide(const std::vector<PageVertex>& vertices) {
    std::uint32_t bits = 0;
    for (const PageVertex& vertex : vertices) bits |= vertex.offset[0] | vertex.offset[1] | vertex.offset[2];
    return bits > kNarrowMask;
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
    if (header.flags != record.flags || header.vertexCount != record.vertexCount ||
        header.indexCount != record.indexCount || header.rangeCount != record.rangeCount) {
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
        if (stream.offset != place || stream.bytes > bytes.size() - place) {
            return fail("page header: place of {} is wrong", name);
        }
        if (hashOf(bytes.subspan(stream.offset, stream.bytes)) != stream.hash) {
            return fail("page {} at byte {} of the page: checksum does not match", name, stream.offset);
        }
        place += stream.bytes;
    }
    if (place != bytes.size()) return fail("page: {} bytes behind its last stream", bytes.size() - place);
    return {};
}

Result<std::vector<Range>> readRanges(std::span<const std::byte> coded, const PageRecord& record) {
    if (coded.size() != std::size_t{record.rangeCount} * sizeof(Range))
        return fail("page ranges: wrong length");
    std::vector<Range> ranges(record.rangeCount);
    std::memcpy(ranges.data(), coded.data(), coded.size());
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        const Range& range = ranges[i];
        const bool inOrder = range.firstIndex == next && range.indexCount > 0 && range.indexCount % 3 == 0 &&
                             range.indexCount <= record.indexCount - next;
        if (!inOrder) return fail("page range {}: does not follow the one before", i);
        for (int axis = 0; axis < 3; ++axis) {
            if (range.boxMin[axis] > range.boxMax[axis]) return fail("page range {}: box is inside out", i);
        }
        next += range.indexCount;
    }
    if (next != record.indexCount)
        return fail("page ranges: cover {} of {} indices", next, record.indexCount);
    return ranges;
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
    const bool good = (record.flags & ~(kPageWide | kPageColors | kPageNormals)) == 0 &&
                      record.vertexCount >= 1 && record.vertexCount <= kMaxPageVertices &&
                      record.indexCount >= 3 && record.indexCount % 3 == 0 &&
                      record.indexCount <= kMaxPageIndices && record.rangeCount >= 1 &&
                      record.rangeCount <= record.indexCount / 3 && record.bytes >= kPageHeaderBytes &&
                      record.bytes <= kMaxPageBytes;
    if (good) return {};
    return fail("page record: impossible: {} bytes, {} vertices, {} indices, {} ranges, flags {}",
                record.bytes, record.vertexCount, record.indexCount, record.rangeCount, record.flags);
}

std::vector<std::byte> encodePage(const PageGeometry& page, PageRecord& record) {
    CHECK_OP(page.vertices.size(), <=, kMaxPageVertices);
    CHECK_OP(page.indices.size(), <=, kMaxPageIndices);
    PageHeader header{};
    header.magic = kPageMagic;
    header.version = kDatasetVersion;
    header.flags = page.attributes | (isWide(page.vertices) ? kPageWide : 0u);
    header.vertexCount = static_cast<std::uint32_t>(page.vertices.size());
    header.indexCount = static_cast<std::uint32_t>(page.indices.size());
    header.rangeCount = static_cast<std::uint32_t>(page.ranges.size());
    for (std::size_t axis = 0; axis < 3; ++axis) header.origin[axis] = page.origin[axis];

    std::vector<std::byte> bytes(sizeof(header));
    append(bytes, header, kRanges, std::as_bytes(std::span(page.ranges)));
    append(bytes, header, kPositions,
           (header.flags & kPageWide) != 0
               ? codeMember(page.vertices, [](const PageVertex& v) { return std::to_array(v.offset); })
               : codeMember(page.vertices, [](const PageVertex& v) { return packNarrow(v.offset); }));
    if ((header.flags & kPageColors) != 0) {
        append(bytes, header, kColors,
               codeMember(page.vertices, [](const PageVertex& v) { return v.color; }));
    }
    if ((header.flags & kPageNormals) != 0) {
        append(bytes, header, kNormals,
               codeMember(page.vertices, [](const PageVertex& v) { return v.normal; }));
    }
    append(bytes, header, kIndices, codeIndices(page.indices, page.vertices.size()));
    header.hash = headerHash(header);
    std::memcpy(bytes.data(), &header, sizeof(header));

    record.bytes = static_cast<std::uint32_t>(bytes.size());
    record.vertexCount = header.vertexCount;
    record.indexCount = header.indexCount;
    record.rangeCount = header.rangeCount;
    record.flags = header.flags;
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
    const auto vertices = [&](Stream s, std::uint32_t place, std::uint32_t stride) -> Result<void> {
        if (meshopt_decodeVertexBuffer(out.data() + place, record.vertexCount, stride,
                                       reinterpret_cast<const unsigned char*>(stream(s).data()),
                                       stream(s).size()) == 0) {
            return {};
        }
        return fail("page {}: cannot be decoded", kStreamNames[s]);
    };
    ASSIGN_OR_RETURN(std::vector<Range> ranges, readRanges(stream(kRanges), record));
    RETURN_IF_ERROR(vertices(kPositions, layout.positions, layout.positionStride));
    if ((record.flags & kPageColors) != 0) RETURN_IF_ERROR(vertices(kColors, layout.colors, 4));
    if ((record.flags & kPageNormals) != 0) RETURN_IF_ERROR(vertices(kNormals, layout.normals, 4));
    RETURN_IF_ERROR(decodeIndices(stream(kIndices), record, out.data() + layout.indices));
    return PageTable{LatticePoint(header.origin[0], header.origin[1], header.origin[2]), std::move(ranges)};
}

glm::u32vec3 pageOffset(std::span<const std::byte> decoded, const PageRecord& record, std::uint32_t index) {
    const PageLayout layout = pageLayout(record);
    const std::byte* at = decoded.data() + layout.positions + std::size_t{index} * layout.positionStride;
    if ((record.flags & kPageWide) != 0) {
        glm::u32vec3 offset;
        std::memcpy(&offset, at, sizeof(offset));
        return offset;
    }
    std::uint64_t packed = 0;
    std::memcpy(&packed, at, sizeof(packed));
    return glm::u32vec3(std::uint32_t(packed) & kNarrowMask,
                        std::uint32_t(packed >> kNarrowBits) & kNarrowMask,
                        std::uint32_t(packed >> (2 * kNarrowBits)) & kNarrowMask);
}

}  // namespace iwalk
