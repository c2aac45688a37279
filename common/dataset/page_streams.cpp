// Streams are coded with meshoptimizer's vertex codec, which promises to stay in bounds on any input;
// whatever it does not promise is checked by those who decode.
#include "common/dataset/page_streams.hpp"

#include <meshoptimizer.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <limits>

#include "common/dataset/page.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kNarrowMask = (1u << kNarrowBits) - 1;

std::uint64_t packNarrow(const PageOffset& offset) {
    return std::uint64_t{offset[0]} | std::uint64_t{offset[1]} << kNarrowBits |
           std::uint64_t{offset[2]} << (2 * kNarrowBits);
}

}  // namespace

PageOffset offsetFrom(const LatticePoint& origin, const LatticePoint& point) {
    PageOffset offset{};
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        const std::int64_t steps = point[axis] - origin[axis];
        CHECK_OP(steps, <=, std::int64_t{std::numeric_limits<std::uint32_t>::max()});
        offset[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(steps);
    }
    return offset;
}

std::uint64_t hashOf(std::span<const std::byte> bytes) {
    return XXH64(bytes.data(), bytes.size(), 0);
}

StreamRecord appendStream(std::vector<std::byte>& bytes, std::span<const std::byte> coded) {
    const StreamRecord record{static_cast<std::uint32_t>(bytes.size()),
                              static_cast<std::uint32_t>(coded.size()), hashOf(coded)};
    bytes.insert(bytes.end(), coded.begin(), coded.end());
    return record;
}

Result<void> checkStream(std::span<const std::byte> block, const StreamRecord& stream, const char* name,
                         std::size_t& place) {
    if (stream.offset != place || stream.bytes > block.size() - place) {
        return fail("header: place of {} is wrong", name);
    }
    if (hashOf(block.subspan(stream.offset, stream.bytes)) != stream.hash) {
        return fail("{} at byte {}: checksum does not match", name, stream.offset);
    }
    place += stream.bytes;
    return {};
}

std::vector<std::byte> codeItems(std::span<const std::byte> items, std::size_t stride) {
    const std::size_t count = items.size() / stride;
    std::vector<std::byte> coded(meshopt_encodeVertexBufferBound(count, stride));
    coded.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(coded.data()), coded.size(),
                                            items.data(), count, stride));
    return coded;
}

Result<void> decodeItems(std::span<const std::byte> coded, const char* name, std::size_t count,
                         std::size_t stride, std::byte* out) {
    if (meshopt_decodeVertexBuffer(out, count, stride, reinterpret_cast<const unsigned char*>(coded.data()),
                                   coded.size()) == 0) {
        return {};
    }
    return fail("{}: cannot be decoded", name);
}

bool needsWide(std::span<const PageOffset> offsets) {
    std::uint32_t bits = 0;
    for (const PageOffset& offset : offsets) bits |= offset[0] | offset[1] | offset[2];
    return bits > kNarrowMask;
}

std::vector<std::byte> codePositions(const std::vector<PageOffset>& offsets, bool wide) {
    if (wide) return codeItems(offsets);
    std::vector<std::uint64_t> packed;
    packed.reserve(offsets.size());
    for (const PageOffset& offset : offsets) packed.push_back(packNarrow(offset));
    return codeItems(packed);
}

glm::u32vec3 unpackPosition(const std::byte* item, bool wide) {
    if (wide) {
        glm::u32vec3 offset;
        std::memcpy(&offset, item, sizeof(offset));
        return offset;
    }
    std::uint64_t packed = 0;
    std::memcpy(&packed, item, sizeof(packed));
    return glm::u32vec3(std::uint32_t(packed) & kNarrowMask,
                        std::uint32_t(packed >> kNarrowBits) & kNarrowMask,
                        std::uint32_t(packed >> (2 * kNarrowBits)) & kNarrowMask);
}

}  // namespace iwalk
