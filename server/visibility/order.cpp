#include "server/visibility/order.hpp"

#include <array>
#include <bit>
#include <numeric>

namespace iwalk {
namespace {

// Radix sort: comparing some 10,000 floats takes several times as long. Floats that are not negative have the
// order of their bits.
std::vector<std::uint32_t> sorted(std::span<const float> keys, std::uint32_t flip) {
    constexpr unsigned kBits = 11, kDigits = 3;
    constexpr std::uint32_t kMask = (1u << kBits) - 1;
    const auto digit = [&](std::uint32_t place, unsigned d) {
        return (std::bit_cast<std::uint32_t>(keys[place]) ^ flip) >> kBits * d & kMask;
    };
    std::vector<std::uint32_t> places(keys.size()), next(keys.size());
    std::iota(places.begin(), places.end(), 0u);
    for (unsigned d = 0; d < kDigits; ++d) {
        std::array<std::uint32_t, kMask + 2> begin{};
        for (const std::uint32_t place : places) ++begin[digit(place, d) + 1];
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        for (const std::uint32_t place : places) next[begin[digit(place, d)]++] = place;
        places.swap(next);
    }
    return places;
}

}  // namespace

std::vector<std::uint32_t> leastFirst(std::span<const float> keys) {
    return sorted(keys, 0);
}

std::vector<std::uint32_t> greatestFirst(std::span<const float> keys) {
    return sorted(keys, 0xffffffff);
}

}  // namespace iwalk
