#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

enum class PlyFormat { ascii, littleEndian, bigEndian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t plyTypeBytes(PlyType type);
inline bool isFloat(PlyType type) {
    return type >= PlyType::float32;
}

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::int8;  // of the value, or of a list's items
    bool list = false;
    PlyType countType = PlyType::uint8;  // of a list's length
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;  // checked against the file's size by checkPlyCounts()
    std::vector<PlyProperty> properties;

    bool hasLists() const;
    // The fewest bytes a record can take in a file of this format, empty lists assumed.
    std::uint64_t leastBytes(PlyFormat format) const;
};

struct PlyHeader {
    PlyFormat format = PlyFormat::ascii;
    std::vector<PlyElement> elements;  // names differ
    std::uint64_t bytes = 0;           // where the data begins

    const PlyElement* find(std::string_view name) const;
};

// A header longer than this is none.
inline constexpr std::size_t kMaxPlyHeaderBytes = std::size_t{1} << 20;

// `text` begins with the file's first byte and may run on into the data. Errors name `path` and the header's
// line.
Result<PlyHeader> parsePlyHeader(std::string_view text, const std::string& path);

// Fails when an element's count cannot be true in a file of `fileBytes`. To be called before anything is
// allocated.
Result<void> checkPlyCounts(const PlyHeader& header, std::uint64_t fileBytes, const std::string& path);

}  // namespace iwalk
