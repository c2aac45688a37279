#pragma once

#include <array>
#include <cstdint>
#include <cstring>

namespace iwalk {

// Four floats that are computed with at once. Every lane is rounded as a single float would be: the same on
// all machines.
using Four [[gnu::vector_size(16)]] = float;

inline Four loadFour(const float* from) {
    Four values;
    std::memcpy(&values, from, sizeof(values));
    return values;
}
inline void storeFour(float* to, Four values) {
    std::memcpy(to, &values, sizeof(values));
}
inline Four fourOf(float value) {
    return Four{value, value, value, value};
}
inline Four absolute(Four values) {
    using Bits [[gnu::vector_size(16)]] = std::int32_t;
    return reinterpret_cast<Four>(reinterpret_cast<Bits>(values) & 0x7fffffff);
}
inline Four lesser(Four a, Four b) {
    return a < b ? a : b;
}
inline bool anyAtMost(Four values, float limit) {
    const auto lanes = values <= limit;  // all bits of a lane or none
    std::array<std::uint64_t, 2> bits{};
    std::memcpy(bits.data(), &lanes, sizeof(lanes));
    return (bits[0] | bits[1]) != 0;
}

}  // namespace iwalk
