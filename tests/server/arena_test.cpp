#include "server/cache/arena.hpp"

#include <gtest/gtest.h>

#include <random>

namespace iwalk {
namespace {

constexpr std::uint64_t kAlignment = 256;

TEST(Arena, PlacesAreAlignedAndLieInTheirBank) {
    std::vector<std::byte> a(1024), b(4096);
    Arena arena({a, b}, kAlignment);
    EXPECT_EQ(arena.largestBank(), 4096u);
    const auto place = arena.allocate(1025);
    ASSERT_TRUE(place);
    EXPECT_EQ(place->bank, 1u);
    EXPECT_EQ(place->offset % kAlignment, 0u);
    EXPECT_EQ(place->bytes, 1280u);
    EXPECT_EQ(arena.memory(*place).data(), b.data() + place->offset);
}

TEST(Arena, RefusesWhatDoesNotFitInOneBank) {
    std::vector<std::byte> a(1024), b(1024);
    Arena arena({a, b}, kAlignment);
    EXPECT_FALSE(arena.allocate(1025));
    EXPECT_TRUE(arena.allocate(1024));
    EXPECT_TRUE(arena.allocate(1024));
    EXPECT_FALSE(arena.allocate(1));
}

// However parts are taken and given back, they never overlap, and in the end all is one free part again.
TEST(Arena, JoinsFreedNeighbours) {
    std::vector<std::byte> bank(std::size_t{1} << 20);
    Arena arena({bank}, kAlignment);
    std::mt19937 random(7);
    std::vector<ArenaPlace> held;
    std::vector<int> owner(bank.size() / kAlignment, -1);
    const auto mark = [&](const ArenaPlace& place, int from, int to) {
        for (std::uint64_t i = place.offset / kAlignment; i < (place.offset + place.bytes) / kAlignment;
             ++i) {
            ASSERT_EQ(owner[i], from);
            owner[i] = to;
        }
    };
    for (int round = 0; round < 5000; ++round) {
        if (held.empty() || random() % 3 != 0) {
            const auto place = arena.allocate(1 + random() % 20000);
            if (!place) continue;
            mark(*place, -1, 1);
            held.push_back(*place);
        } else {
            std::swap(held[random() % held.size()], held.back());
            mark(held.back(), 1, -1);
            arena.free(held.back());
            held.pop_back();
        }
    }
    for (const ArenaPlace& place : held) arena.free(place);
    EXPECT_EQ(arena.freeBytes(), bank.size());
    EXPECT_TRUE(arena.allocate(bank.size()));
}

}  // namespace
}  // namespace iwalk
