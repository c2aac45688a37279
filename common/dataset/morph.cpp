// Morph blocks on disk; docs/format.md has every byte. Vertices mostly go where other vertices of their page
// are: a number names such a target in a quarter of the room that a position takes.
#include "common/dataset/morph.hpp"

#include <array>
#include <cstring>
#include <unordered_map>

#include "common/dataset/morph_boxes.hpp"
#include "common/dataset/page_streams.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kMorphMagic = 0x4f4d5749;  // "IWMO"

enum Stream { kBoxes, kNumbers, kExtras, kStreams };
constexpr std::array<const char*, kStreams> kStreamNames{"morph boxes", "morph numbers", "morph extras"};

struct MorphHeader {
    std::uint32_t magic, version, flags, vertexCount, rangeCount, extraCount;
    std::int64_t origin[3];
    StreamRecord streams[kStreams];  // extras: all 0 when there are none
    std::uint64_t hash;              // xxh64 of everything before
};
static_assert(sizeof(MorphHeader) == kMorphHeaderBytes);

std::uint64_t headerHash(const MorphHeader& header) {
    return hashOf(std::as_bytes(std::span(&header, 1)).first(offsetof(MorphHeader, hash)));
}

struct PointHash {
    std::size_t operator()(const LatticePoint& point) const {
        return hashOf(std::as_bytes(std::span(&point, 1)));
    }
};

// Names of targets: the vertex itself, else the first vertex that is there, else an extra position.
struct Numbering {
    explicit Numbering(const MorphSource& page) {
        const auto vertices = static_cast<std::uint32_t>(page.positions.size());
        std::unordered_map<LatticePoint, std::uint32_t, PointHash> places(vertices);
        for (std::uint32_t v = 0; v < vertices; ++v) places.try_emplace(page.positions[v], v);
        for (std::uint32_t v = 0; v < vertices; ++v) {
            const LatticePoint& target = page.targets[v];
            if (target == page.positions[v]) {
                numbers.push_back(v);
                continue;
            }
            const auto next = vertices + static_cast<std::uint32_t>(extras.size());
            const auto [place, isExtra] = places.try_emplace(target, next);
            if (isExtra) extras.push_back(target);
            numbers.push_back(place->second);
        }
    }

    std::vector<std::uint32_t> numbers;
    std::vector<LatticePoint> extras;
};

Result<MorphHeader> readHeader(std::span<const std::byte> bytes, const PageRecord& record) {
    MorphHeader header{};
    if (bytes.size() != record.morphBytes || bytes.size() < sizeof(header)) {
        return fail("morph block of {} bytes where its page record says {}", bytes.size(), record.morphBytes);
    }
    std::memcpy(&header, bytes.data(), sizeof(header));
    if (header.magic != kMorphMagic) return fail("morph header: no morph block begins here");
    if (header.version != kDatasetVersion) {
        return fail("morph header: version {}, but this program reads version {}", header.version,
                    kDatasetVersion);
    }
    if (header.hash != headerHash(header)) return fail("morph header: checksum does not match");
    if (header.flags != (record.flags & kMorphWide) || header.vertexCount != record.vertexCount ||
        header.rangeCount != record.rangeCount) {
        return fail("morph header: flags or counts are not those of its page record");
    }
    if (header.extraCount > header.vertexCount) {
        return fail("morph header: {} extra positions of {} vertices", header.extraCount, header.vertexCount);
    }
    for (const std::int64_t axis : header.origin) {
        if (axis < -kLatticeLimit || axis > kLatticeLimit) return fail("morph header: origin out of bounds");
    }
    RETURN_IF_ERROR(checkPageRecord(record));
    return header;
}

Result<void> checkStreams(std::span<const std::byte> bytes, const MorphHeader& header) {
    std::size_t place = sizeof(header);
    for (std::size_t s = 0; s < kStreams; ++s) {
        const StreamRecord& stream = header.streams[s];
        if (s == kExtras && header.extraCount == 0) {
            const bool blank = stream.offset == 0 && stream.bytes == 0 && stream.hash == 0;
            if (!blank) return fail("morph header: {} where there are none", kStreamNames[s]);
            continue;
        }
        RETURN_IF_ERROR(checkStream(bytes, stream, kStreamNames[s], place));
    }
    if (place != bytes.size()) return fail("morph block: {} bytes behind it", bytes.size() - place);
    return {};
}

// Extra positions come in the order in which vertices first go there.
Result<void> checkNumbers(std::span<const std::uint32_t> numbers, std::size_t extras) {
    std::size_t used = numbers.size();
    const std::size_t all = used + extras;
    for (std::size_t v = 0; v < numbers.size(); ++v) {
        if (numbers[v] > used || numbers[v] >= all) {
            return fail("morph numbers: vertex {} goes to {} of {}", v, numbers[v], all);
        }
        if (numbers[v] == used) ++used;
    }
    if (used == all) return {};
    return fail("morph numbers: no vertex goes to extra position {}", used - numbers.size());
}

Result<void> decodeExtras(std::span<const std::byte> stream, bool wide, std::size_t count, PageMorph& morph) {
    const std::size_t stride = wide ? 12 : 8;
    std::vector<std::byte> items(stride * count);
    RETURN_IF_ERROR(decodeItems(stream, kStreamNames[kExtras], count, stride, items.data()));
    morph.extras.reserve(count);
    for (std::size_t at = 0; at < items.size(); at += stride) {
        morph.extras.push_back(unpackPosition(items.data() + at, wide));
    }
    return {};
}

}  // namespace

std::vector<std::byte> encodeMorph(const MorphSource& page, PageRecord& record) {
    CHECK_OP(page.positions.size(), ==, record.vertexCount);
    CHECK_OP(page.targets.size(), ==, record.vertexCount);
    CHECK_OP(page.ranges.size(), ==, record.rangeCount);
    CHECK_OP(page.indices.size(), ==, record.indexCount);
    LatticeBox box;
    for (const LatticePoint& target : page.targets) box.add(target);
    const Numbering numbering(page);
    std::vector<PageOffset> extras;
    for (const LatticePoint& extra : numbering.extras) extras.push_back(offsetFrom(box.min, extra));

    MorphHeader header{};
    header.magic = kMorphMagic;
    header.version = kDatasetVersion;
    header.flags = needsWide(extras) ? kMorphWide : 0u;
    header.vertexCount = record.vertexCount;
    header.rangeCount = record.rangeCount;
    header.extraCount = static_cast<std::uint32_t>(extras.size());
    for (glm::length_t axis = 0; axis < 3; ++axis) header.origin[axis] = box.min[axis];
    std::vector<std::byte> bytes(sizeof(header));
    header.streams[kBoxes] = appendStream(bytes, codeMorphBoxes(page, box.min));
    header.streams[kNumbers] = appendStream(bytes, codeItems(numbering.numbers));
    if (!extras.empty()) {
        header.streams[kExtras] = appendStream(bytes, codePositions(extras, header.flags != 0));
    }
    header.hash = headerHash(header);
    std::memcpy(bytes.data(), &header, sizeof(header));

    record.morphBytes = static_cast<std::uint32_t>(bytes.size());
    record.flags |= header.flags;
    CHECK_OP(checkPageRecord(record).ok(), ==, true);
    return bytes;
}

Result<PageMorph> decodeMorph(std::span<const std::byte> bytes, const PageRecord& record,
                              const PageTable& table) {
    CHECK_OP(table.ranges.size(), ==, record.rangeCount);
    ASSIGN_OR_RETURN(const MorphHeader header, readHeader(bytes, record));
    RETURN_IF_ERROR(checkStreams(bytes, header));
    const auto stream = [&](Stream s) {
        return bytes.subspan(header.streams[s].offset, header.streams[s].bytes);
    };
    PageMorph morph;
    morph.origin = LatticePoint(header.origin[0], header.origin[1], header.origin[2]);
    ASSIGN_OR_RETURN(morph.boxes, decodeMorphBoxes(stream(kBoxes), table, morph.origin));
    ASSIGN_OR_RETURN(morph.numbers, decodeItems<std::uint32_t>(stream(kNumbers), kStreamNames[kNumbers],
                                                               header.vertexCount));
    RETURN_IF_ERROR(checkNumbers(morph.numbers, header.extraCount));
    if (header.extraCount > 0) {
        RETURN_IF_ERROR(decodeExtras(stream(kExtras), header.flags != 0, header.extraCount, morph));
    }
    return morph;
}

std::vector<LatticePoint> targetsOf(const PageMorph& morph, std::span<const LatticePoint> positions) {
    CHECK_OP(positions.size(), ==, morph.numbers.size());
    std::vector<LatticePoint> targets;
    targets.reserve(positions.size());
    for (const std::uint32_t number : morph.numbers) {
        targets.push_back(number < positions.size()
                              ? positions[number]
                              : morph.origin + LatticePoint(morph.extras[number - positions.size()]));
    }
    return targets;
}

}  // namespace iwalk
