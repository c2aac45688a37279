// A page's size (4 bytes), the page, and its morph block, if something is left. Checksums are made right, and
// counts that stand in several places alike, before each look, so that what lies behind them is reached.
#include "common/dataset/page.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>

#include "common/dataset/morph.hpp"
#include "tests/common/page_sample.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace iwalk;

constexpr std::size_t kFlags = 8, kVertices = 12, kIndices = 16, kRanges = 20;  // places in a page's header
constexpr std::size_t kMorphRanges = 16;  // in a morph block's; flags and vertices as in a page's
constexpr std::size_t kFirstStream = 48, kStreamBytes = 16;  // the first record of a stream; each one's size
constexpr std::size_t kPageStreams = 5, kMorphStreams = 3;

std::uint32_t numberAt(std::span<const std::byte> bytes, std::size_t place) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + place, sizeof value);
    return value;
}

void putNumber(std::span<std::byte> bytes, std::size_t place, std::uint32_t value) {
    std::memcpy(bytes.data() + place, &value, sizeof value);
}

void putHash(std::span<std::byte> bytes, std::size_t place, std::size_t begin, std::size_t size) {
    const XXH64_hash_t hash = XXH64(bytes.data() + begin, size, 0);
    std::memcpy(bytes.data() + place, &hash, sizeof hash);
}

void putHashes(std::span<std::byte> bytes, std::size_t streams, std::size_t headerBytes) {
    for (std::size_t stream = 0; stream < streams; ++stream) {
        const std::size_t place = kFirstStream + stream * kStreamBytes;
        const std::size_t begin = numberAt(bytes, place), size = numberAt(bytes, place + 4);
        if (size > 0 && begin <= bytes.size() && size <= bytes.size() - begin)
            putHash(bytes, place + 8, begin, size);
    }
    putHash(bytes, headerBytes - 8, 0, headerBytes - 8);
}

PageRecord recordOf(std::span<const std::byte> page, std::span<const std::byte> morph) {
    PageRecord record{};
    record.bytes = static_cast<std::uint32_t>(page.size());
    record.morphBytes = static_cast<std::uint32_t>(morph.size());
    record.flags = numberAt(page, kFlags) & ~std::uint32_t{kMorphWide};
    record.vertexCount = numberAt(page, kVertices);
    record.indexCount = numberAt(page, kIndices);
    record.rangeCount = numberAt(page, kRanges);
    if (!morph.empty()) record.flags |= numberAt(morph, kFlags) & std::uint32_t{kMorphWide};
    return record;
}

// False when it is refused, with an error as people want them.
template <class T>
bool good(const Result<T>& result) {
    if (!result.ok()) CHECK(result.error().message.find('\n') == std::string::npos);
    return result.ok();
}

void decode(std::span<const std::byte> page, std::span<const std::byte> morphBlock,
            const PageRecord& record) {
    if (!good(checkPageRecord(record))) return;
    std::vector<std::byte> out(pageLayout(record).bytes);
    const auto table = decodePage(page, record, out);
    if (!good(table)) return;
    for (const Range& range : table->ranges)
        CHECK_OP(std::uint64_t{range.firstIndex} + range.indexCount, <=, record.indexCount);
    const std::vector<LatticePoint> positions = latticePositions(*table, out, record);
    CHECK_OP(positions.size(), ==, record.vertexCount);
    if (morphBlock.empty()) return;
    const auto morph = decodeMorph(morphBlock, record, *table);
    if (!good(morph)) return;
    CHECK_OP(morph->boxes.size(), ==, table->ranges.size());
    CHECK_OP(targetsOf(*morph, positions).size(), ==, positions.size());
}

std::string seed(std::uint32_t triangles, int bits, std::uint32_t attributes, bool morphs) {
    const PageGeometry page = makePage(triangles, bits, attributes);
    PageRecord record{};
    std::vector<std::byte> bytes = encodePage(page, record);
    const std::uint32_t size = record.bytes;
    if (morphs) {
        std::vector<LatticePoint> positions;
        for (const PageVertex& vertex : page.vertices)
            positions.push_back(page.origin +
                                LatticePoint(vertex.offset[0], vertex.offset[1], vertex.offset[2]));
        // Some stay, most go to others, one where none is.
        std::vector<LatticePoint> targets = positions;
        for (std::size_t v = 0; v + 3 < targets.size(); v += 2) targets[v] = positions[v + 3];
        targets[1] = page.origin + LatticePoint(1, 2, 3);
        const auto block = encodeMorph({page.origin, positions, targets, page.ranges, page.indices}, record);
        bytes.insert(bytes.end(), block.begin(), block.end());
    }
    std::string text(reinterpret_cast<const char*>(&size), sizeof size);
    text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 4 + kPageHeaderBytes) return 0;
    std::vector<std::byte> all;
    std::ranges::copy(std::as_bytes(std::span(data, size)), std::back_inserter(all));
    const std::span<std::byte> rest = std::span(all).subspan(4);
    const std::size_t pageBytes = std::clamp<std::size_t>(numberAt(all, 0), kPageHeaderBytes, rest.size());
    const std::span<std::byte> page = rest.first(pageBytes);
    std::span<std::byte> morph = rest.subspan(pageBytes);
    putHashes(page, kPageStreams, kPageHeaderBytes);
    if (morph.size() < kMorphHeaderBytes) morph = {};
    if (!morph.empty()) {
        putNumber(morph, kVertices, numberAt(page, kVertices));
        putNumber(morph, kMorphRanges, numberAt(page, kRanges));
        putHashes(morph, kMorphStreams, kMorphHeaderBytes);
    }
    decode(page, morph, recordOf(page, morph));
    return 0;
}

std::vector<std::string> iwalk::fuzzSeeds() {
    return {seed(20, 21, 0, false), seed(20, 30, kPageColors | kPageNormals, false),
            seed(12, 12, kPageColors, true), seed(30, 30, kPageNormals, true)};
}
