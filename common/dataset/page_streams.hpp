#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "common/geometry.hpp"
#include "common/result.hpp"

// Inside common/dataset only: the streams that pages and morph blocks are made of.
namespace iwalk {

struct StreamRecord {
    std::uint32_t offset, bytes;  // from the block's start; all 0 when the block does not have the stream
    std::uint64_t hash;           // xxh64 of the stream
};
static_assert(sizeof(StreamRecord) == 16);

using PageOffset = std::array<std::uint32_t, 3>;  // steps from an origin
// `origin` is the lower in each axis, by less than 2^32 steps.
PageOffset offsetFrom(const LatticePoint& origin, const LatticePoint& point);

std::uint64_t hashOf(std::span<const std::byte> bytes);

// Appends a stream behind what is there.
StreamRecord appendStream(std::vector<std::byte>& bytes, std::span<const std::byte> coded);

// Whether the stream lies at `place` of its block and is undamaged; moves `place` behind it. `name` is for
// messages.
Result<void> checkStream(std::span<const std::byte> block, const StreamRecord& stream, const char* name,
                         std::size_t& place);

// meshoptimizer's vertex codec; items of at most 256 bytes, a multiple of 4. Decoding writes `count` of them.
std::vector<std::byte> codeItems(std::span<const std::byte> items, std::size_t stride);
Result<void> decodeItems(std::span<const std::byte> coded, const char* name, std::size_t count,
                         std::size_t stride, std::byte* out);

template <class T>
std::vector<std::byte> codeItems(const std::vector<T>& items) {
    return codeItems(std::as_bytes(std::span(items)), sizeof(T));
}
template <class T>
Result<std::vector<T>> decodeItems(std::span<const std::byte> coded, const char* name, std::size_t count) {
    std::vector<T> items(count);
    RETURN_IF_ERROR(
        decodeItems(coded, name, count, sizeof(T), std::as_writable_bytes(std::span(items)).data()));
    return items;
}

// Differences of either sign, modulo 2^32, so that small ones have high bytes of 0.
inline std::uint32_t zigzag(std::uint32_t difference) {
    return difference << 1 ^ (difference >> 31 != 0 ? ~0u : 0u);
}
inline std::uint32_t unzigzag(std::uint32_t code) {
    return code >> 1 ^ ((code & 1) != 0 ? ~0u : 0u);
}

// Positions in 8 bytes each, or 12 when one needs it.
bool needsWide(std::span<const PageOffset> offsets);
std::vector<std::byte> codePositions(const std::vector<PageOffset>& offsets, bool wide);
glm::u32vec3 unpackPosition(const std::byte* item, bool wide);

}  // namespace iwalk
