#pragma once

#include <algorithm>
#include <cstdint>

#include "preprocess/import/importer.hpp"

namespace iwalk {

// What an importer's buffers take besides kept vertices: read buffer or block of text (a header or line of
// 1 MiB at most, twice while it grows), batches of vertices and triangles, block tables.
inline constexpr std::uint64_t kImportBufferBytes = std::uint64_t{4} << 20;

// The least that an importer can work with.
inline constexpr std::uint64_t kLeastImporterBytes = std::uint64_t{16} << 20;

// A block of text that is parsed beside others takes some 0.6 MB; this much when it is a line of 1 MiB.
inline constexpr std::uint64_t kTextBlockBytes = std::uint64_t{3} << 20;

// How many blocks of text are in memory at once: enough to keep all threads busy, in a quarter of the memory.
inline std::size_t blocksAtOnce(const ImportLimits& limits) {
    if (limits.threads <= 1) return 1;
    const std::uint64_t most = std::max<std::uint64_t>(limits.memoryBytes / 4 / kTextBlockBytes, 1);
    return static_cast<std::size_t>(std::min<std::uint64_t>(2 * std::uint64_t{limits.threads}, most));
}

// The part of an importer's memory that kept vertices may take; `text`: the file is parsed in blocks.
inline std::uint64_t storeBytes(const ImportLimits& limits, bool text) {
    const std::uint64_t blocks = text ? (blocksAtOnce(limits) - 1) * kTextBlockBytes : 0;
    return limits.memoryBytes - std::min(limits.memoryBytes, kImportBufferBytes + blocks);
}

}  // namespace iwalk
