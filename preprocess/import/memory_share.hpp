#pragma once

#include <algorithm>
#include <cstdint>

namespace iwalk {

// What an importer's buffers take besides kept vertices: read buffer (a header or line of 1 MiB at most,
// twice while it grows), batches of vertices and triangles, block tables.
inline constexpr std::uint64_t kImportBufferBytes = std::uint64_t{4} << 20;

// The least that an importer can work with.
inline constexpr std::uint64_t kLeastImporterBytes = std::uint64_t{16} << 20;

// The part of an importer's memory that kept vertices may take.
inline std::uint64_t storeBytes(std::uint64_t memoryBytes) {
    return memoryBytes - std::min(memoryBytes, kImportBufferBytes);
}

}  // namespace iwalk
