// Morph blocks that are damaged, or made to do harm.
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "tests/common/morph_sample.hpp"

namespace iwalk {
namespace {

TEST(MorphForgeryTest, EveryTruncationIsFound) {
    const MorphSample sample(20, 21, Targets::kVerticesAndExtras);
    for (std::size_t length = 0; length < sample.bytes.size(); ++length) {
        MorphSample shorter = sample;
        shorter.bytes.resize(length);
        EXPECT_FALSE(shorter.decoded().ok()) << length;
        shorter.record.morphBytes = static_cast<std::uint32_t>(length);
        EXPECT_FALSE(shorter.decoded().ok()) << length;
    }
}

TEST(MorphForgeryTest, EveryFlippedByteIsFound) {
    for (const Targets kind : {Targets::kVertices, Targets::kVerticesAndExtras}) {
        MorphSample sample(20, 32, kind);
        for (std::byte& byte : sample.bytes) {
            byte ^= std::byte{0x10};
            EXPECT_FALSE(sample.decoded().ok()) << &byte - sample.bytes.data();
            byte ^= std::byte{0x10};
        }
        EXPECT_TRUE(sample.decoded().ok());
    }
}

// Streams that are wrong under right checksums give other targets or an error, but never a number of nothing.
TEST(MorphForgeryTest, NoStreamCanDoHarm) {
    std::mt19937 random(3);
    const MorphSample good(200, 21, Targets::kVerticesAndExtras);
    for (int i = 0; i < 3000; ++i) {
        MorphSample sample = good;
        const std::size_t from = sample.get(i % 3 == 0 ? 48 : 64);
        for (std::size_t changes = 1 + random() % 4; changes > 0; --changes) {
            sample.bytes[from + random() % (sample.bytes.size() - from)] = static_cast<std::byte>(random());
        }
        sample.seal();
        const auto morph = sample.decoded();
        if (!morph) continue;
        EXPECT_EQ(targetsOf(*morph, sample.positions).size(), sample.targets.size());
    }
}

// Right checksums over a header that is wrong.
TEST(MorphForgeryTest, ForgedHeadersAreFound) {
    const auto refused = [](const char* why, std::size_t place, std::uint64_t value, std::size_t bytes) {
        MorphSample sample(20, 21, Targets::kVerticesAndExtras);
        std::memcpy(sample.bytes.data() + place, &value, bytes);
        sample.seal();
        const auto morph = sample.decoded();
        ASSERT_FALSE(morph.ok()) << why;
        EXPECT_NE(morph.error().message.find(why), std::string::npos) << morph.error().message;
    };
    refused("no morph block begins here", 0, 0x47505749, 4);
    refused("version 2, but", 4, 2, 4);
    refused("flags or counts", 8, kMorphWide, 4);
    refused("flags or counts", 12, 21, 4);
    refused("flags or counts", 16, 3, 4);
    refused("23 extra positions of 22 vertices", 20, 23, 4);
    refused("goes to", 20, 1, 4);
    refused("morph extras where there are none", 20, 0, 4);
    refused("no vertex goes to extra position", 20, 22, 4);
    refused("origin out of bounds", 24, std::uint64_t{1} << 62, 8);
    refused("place of morph boxes", 48, 105, 4);
    refused("morph boxes", 52, 0xffffffff, 4);
    refused("place of morph numbers", 64, 0, 4);
    refused("place of morph extras", 80, 0, 4);
}

template <class T>
std::vector<std::byte> coded(const std::vector<T>& items) {
    std::vector<std::byte> bytes(meshopt_encodeVertexBufferBound(items.size(), sizeof(T)));
    bytes.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                                            items.data(), items.size(), sizeof(T)));
    return bytes;
}

TEST(MorphForgeryTest, ForgedNumbersAreFound) {
    const MorphSample good(20, 21, Targets::kVertices);
    const auto withNumber = [&](std::size_t vertex, std::uint32_t number) {
        MorphSample sample = good;
        std::vector<std::uint32_t> numbers = sample.decoded().value().numbers;
        numbers[vertex] = number;
        sample.replaceLast(64, coded(numbers));
        sample.seal();
        const auto morph = sample.decoded();
        return morph ? "" : morph.error().message;
    };
    EXPECT_EQ(withNumber(7, 21), "");
    EXPECT_EQ(withNumber(7, 22), "morph numbers: vertex 7 goes to 22 of 22");
    EXPECT_EQ(withNumber(21, kFarthest), "morph numbers: vertex 21 goes to 4294967295 of 22");
}

TEST(MorphForgeryTest, ForgedBoxesAreFound) {
    MorphSample sample(20, 21, Targets::kVertices);
    // All of a sudden the ranges are elsewhere.
    sample.table.ranges[1].boxMin[2] = 1u << 31;
    const auto morph = sample.decoded();
    ASSERT_FALSE(morph.ok());
    EXPECT_EQ(morph.error().message, "morph box 1: is inside out");
}

}  // namespace
}  // namespace iwalk
