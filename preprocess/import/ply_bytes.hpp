#pragma once

#include <array>
#include <bit>
#include <cstring>

#include "preprocess/import/ply_header.hpp"

namespace iwalk {

static_assert(std::endian::native == std::endian::little, "little-endian files are read as they are");

// A value at `bytes`, aligned or not, from little-endian or (swap) big-endian.
template <class T, bool swap>
T loadBytes(const char* bytes) {
    std::array<char, sizeof(T)> raw;
    for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[swap ? sizeof(T) - 1 - i : i];
    return std::bit_cast<T>(raw);
}

// Calls `f` with a value of the C++ type that `type` stands for.
template <class F>
decltype(auto) withPlyType(PlyType type, F&& f) {
    switch (type) {
        case PlyType::int8:
            return f(std::int8_t{});
        case PlyType::uint8:
            return f(std::uint8_t{});
        case PlyType::int16:
            return f(std::int16_t{});
        case PlyType::uint16:
            return f(std::uint16_t{});
        case PlyType::int32:
            return f(std::int32_t{});
        case PlyType::uint32:
            return f(std::uint32_t{});
        case PlyType::float32:
            return f(float{});
        case PlyType::float64:
            break;
    }
    return f(double{});
}

}  // namespace iwalk
