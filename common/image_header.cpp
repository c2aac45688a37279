#include "common/image_header.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace iwalk {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::int64_t kMaxSide = 32768;  // px
// Deflate makes at most 1032 bytes of one, so a file that claims more pixels than that is damaged or hostile.
constexpr std::int64_t kMaxInflation = 1032;
constexpr std::int64_t kInflationSlack = 4096;  // bytes

std::uint32_t byteAt(Bytes bytes, std::size_t i) {
    return std::to_integer<std::uint32_t>(bytes[i]);
}

std::uint32_t bigEndian32(Bytes b) {
    return byteAt(b, 0) << 24 | byteAt(b, 1) << 16 | byteAt(b, 2) << 8 | byteAt(b, 3);
}

std::uint32_t littleEndian32(Bytes b) {
    return byteAt(b, 0) | byteAt(b, 1) << 8 | byteAt(b, 2) << 16 | byteAt(b, 3) << 24;
}

std::string_view text(Bytes b) {
    return {reinterpret_cast<const char*>(b.data()), b.size()};
}

constexpr std::array<std::uint32_t, 256> crcTable() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        table[i] = i;
        for (int bit = 0; bit < 8; ++bit) table[i] = (table[i] >> 1) ^ ((table[i] & 1) ? 0xedb88320u : 0u);
    }
    return table;
}

std::uint32_t crc32(Bytes bytes) {
    static constexpr auto kTable = crcTable();
    std::uint32_t crc = 0xffffffff;
    for (std::byte byte : bytes)
        crc = (crc >> 8) ^ kTable[(crc ^ std::to_integer<std::uint32_t>(byte)) & 0xff];
    return ~crc;
}

Result<void> checkSize(std::int64_t width, std::int64_t height, std::int64_t pixelBytes, Bytes file,
                       const std::string& name) {
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
        return fail("{}: the image is {} x {} pixels; it must be from 1 x 1 to {} x {}", name, width, height,
                    kMaxSide, kMaxSide);
    }
    const auto fileBytes = static_cast<std::int64_t>(file.size());
    if (width * height * pixelBytes > kMaxInflation * fileBytes + kInflationSlack) {
        return fail("{}: {} bytes cannot hold {} x {} pixels; the file is damaged", name, fileBytes, width,
                    height);
    }
    return {};
}

// `data` is what the chunk IHDR holds: width, height, bits, colour type, compression, filter, interlace.
Result<void> checkPngStart(Bytes data, Bytes file, const std::string& name) {
    if (data.size() != 13) return fail("{}: the PNG header has {} bytes instead of 13", name, data.size());
    const std::uint32_t bits = byteAt(data, 8), colorType = byteAt(data, 9);
    if (bits != 8 || colorType != 2) {
        return fail("{}: the PNG has colour type {} with {} bits; needed: type 2 (RGB) with 8 bits", name,
                    colorType, bits);
    }
    return checkSize(bigEndian32(data), bigEndian32(data.subspan(4)), 3, file, name);
}

// The attributes of an OpenEXR header that decide what a reader allocates.
Result<void> checkExrAttribute(std::string_view key, Bytes value, Bytes file, const std::string& name) {
    if (key == "channels") {
        // name, type (2: float), linearity and padding, sampling in x and y, end of list.
        static constexpr char kOneFloatZ[] = "Z\0\2\0\0\0\0\0\0\0\1\0\0\0\1\0\0\0";
        const bool same =
            value.size() == sizeof kOneFloatZ && text(value.first(6)) == std::string_view(kOneFloatZ, 6) &&
            text(value.subspan(10)) == std::string_view(kOneFloatZ + 10, sizeof kOneFloatZ - 10);
        if (!same) return fail("{}: the EXR must have one channel, Z, of 32-bit float", name);
    } else if (key == "compression") {
        if (value.size() != 1 || byteAt(value, 0) > 3) {
            return fail("{}: the EXR's compression must be ZIP, ZIPS, RLE or none", name);
        }
    } else if (key == "type") {
        if (text(value) != "scanlineimage") return fail("{}: the EXR must be in scanlines", name);
    } else if (key == "dataWindow") {
        if (value.size() != 16) return fail("{}: the EXR's data window is damaged", name);
        std::array<std::int64_t, 4> window;  // left, top, right, bottom, all inside
        for (std::size_t i = 0; i < 4; ++i) {
            window[i] = static_cast<std::int32_t>(littleEndian32(value.subspan(4 * i)));
        }
        return checkSize(window[2] - window[0] + 1, window[3] - window[1] + 1, 4, file, name);
    }
    return {};
}

}  // namespace

Result<void> checkPngHeader(Bytes bytes, const std::string& name) {
    static constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
    if (text(bytes.first(std::min(bytes.size(), kSignature.size()))) != kSignature) {
        return fail("{}: not a PNG file", name);
    }
    // A chunk is its length, four letters, data, and a checksum of letters and data.
    constexpr std::size_t kAround = 12;
    for (std::size_t at = kSignature.size();;) {
        const std::size_t left = bytes.size() - at;
        const std::size_t length = left < kAround ? 0 : bigEndian32(bytes.subspan(at));
        if (left < kAround + length)
            return fail("{}: the PNG file is cut off, in the chunk at byte {}", name, at);

        const Bytes chunk = bytes.subspan(at + 4, 4 + length);
        if (crc32(chunk) != bigEndian32(bytes.subspan(at + 8 + length))) {
            return fail("{}: the PNG file is damaged, in the chunk at byte {}", name, at);
        }
        const std::string_view type = text(chunk.first(4));
        const bool first = at == kSignature.size();
        if (first != (type == "IHDR")) return fail("{}: the PNG's header is not at its beginning", name);
        if (first) RETURN_IF_ERROR(checkPngStart(chunk.subspan(4), bytes, name));
        if (type == "IEND") return {};
        at += kAround + length;
    }
}

Result<void> checkExrHeader(Bytes bytes, const std::string& name) {
    constexpr std::uint32_t kMagic = 20000630, kLongNames = 0x400, kVersion = 2;
    if (bytes.size() < 8 || littleEndian32(bytes) != kMagic) return fail("{}: not an OpenEXR file", name);
    if ((littleEndian32(bytes.subspan(4)) & ~kLongNames) != kVersion) {
        return fail("{}: the EXR must be of version 2, one part, in scanlines", name);
    }
    // An attribute is its name and type, each ended by a zero, its size, and its value; no name ends them
    // all.
    int windows = 0, channelLists = 0;
    for (std::size_t at = 8;;) {
        const std::string_view rest = text(bytes).substr(at);
        if (rest.starts_with('\0')) break;
        const std::size_t keyEnd = rest.find('\0'),
                          typeEnd = rest.find('\0', std::min(keyEnd, rest.size() - 1) + 1);
        if (typeEnd == rest.npos || rest.size() - typeEnd < 5) {
            return fail("{}: the EXR file is cut off, at byte {}", name, at);
        }
        const std::size_t size = littleEndian32(bytes.subspan(at + typeEnd + 1)), head = typeEnd + 5;
        if (rest.size() - head < size) return fail("{}: the EXR file is cut off, at byte {}", name, at);

        const std::string_view key = rest.substr(0, keyEnd);
        RETURN_IF_ERROR(checkExrAttribute(key, bytes.subspan(at + head, size), bytes, name));
        windows += key == "dataWindow", channelLists += key == "channels";
        at += head + size;
    }
    if (windows == 1 && channelLists == 1) return {};
    return fail("{}: the EXR has {} data windows and {} channel lists; it must have one of each", name,
                windows, channelLists);
}

}  // namespace iwalk
