#pragma once

#include <cstdint>

namespace iwalk {

// Random numbers that are the same on every machine: integer arithmetic, and exact conversions to
// floating point. (The distributions of <random> differ between standard libraries.)

// Scrambles 64 bits (the finaliser of splitmix64: Steele, Lea and Flood, Fast Splittable Pseudorandom Number
// Generators, OOPSLA 2014).
constexpr std::uint64_t scramble(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

// A seed for the thing numbered (a, b, c) of what `seed` stands for.
constexpr std::uint64_t seedOf(std::uint64_t seed, std::uint64_t a, std::uint64_t b = 0,
                               std::uint64_t c = 0) {
    std::uint64_t x = scramble(seed + 0x9e3779b97f4a7c15u);
    x = scramble(x + a + 1);
    x = scramble(x + b + 1);
    return scramble(x + c + 1);
}

// Scrambles 32 bits (the finaliser of MurmurHash3).
constexpr std::uint32_t scramble32(std::uint32_t x) {
    x = (x ^ (x >> 16)) * 0x85ebca6bu;
    x = (x ^ (x >> 13)) * 0xc2b2ae35u;
    return x ^ (x >> 16);
}

// A sequence of random numbers: splitmix64. Take one number at a time: the order in which a call's arguments
// are computed is the compiler's (in braces it is not).
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next() { return scramble(state_ += 0x9e3779b97f4a7c15u); }
    double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }  // [0, 1)
    double between(double low, double high) { return low + (high - low) * unit(); }
    std::uint32_t below(std::uint32_t count) {  // 0 to count - 1
        return static_cast<std::uint32_t>(((next() >> 32) * count) >> 32);
    }
    bool chance(double probability) { return unit() < probability; }

  private:
    std::uint64_t state_;
};

}  // namespace iwalk
