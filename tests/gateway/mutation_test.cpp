#include <gtest/gtest.h>

#include <random>

#include "common/protocol.hpp"
#include "tests/gateway/allocation.hpp"

// What a hostile peer may send: every message cut at every place and changed at random never crashes the
// decoder, and never makes it allocate much more than was sent.
namespace iwalk::protocol {
namespace {

Welcome sampleWelcome() {
    Welcome welcome{kVersion, "0.1.0", 10, 1000, {}, 220, 100, {}, {{"cache", "1G"}, {"near", "0"}}};
    welcome.bounds.add(glm::dvec3(0, 0, 0));
    welcome.tiles = {{"tile-0-0", "left", 0, 0, 0, 100, 100}, {"tile-0-1", "right", 1, 120, 0, 100, 100}};
    return welcome;
}

std::vector<Message> samples() {
    return {Hello{kVersion, true, true, "secret"},
            CameraRequest{1, kLockstep, {}},
            sampleWelcome(),
            Control{true},
            FrameDone{1, 2, 3.5, {TileStats{}, TileStats{.tile = 1, .drawMs = 2}}},
            TileImage{1, 1, ImageKind::exr, std::vector<std::byte>(50, std::byte{1})},
            Failure{"grün"},
            ChangeSettings{{{"mode", "plp"}, {"near", "0.5"}}},
            SettingsNow{{{"mode", "plp"}}, "no"}};
}

Result<Message> decode(std::span<const std::byte> bytes) {
    if (bytes.size() < kHeaderBytes) return fail("no header");
    ASSIGN_OR_RETURN(const Header header, decodeHeader(bytes.first<kHeaderBytes>(), kMaxServerPayload));
    return decodePayload(header, bytes.subspan(kHeaderBytes));
}

void writeLength(std::vector<std::byte>& bytes) {
    const std::size_t payload = bytes.size() - kHeaderBytes;
    for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::byte>((payload >> 8 * i) & 0xff);
}

// Decodes; what is accepted must be sendable again. Error texts and the message's own structs are allowed
// for.
void mustBeHarmless(const std::vector<std::byte>& bytes) {
    testing::resetLargestAllocation();
    const Result<Message> decoded = decode(bytes);
    ASSERT_LE(testing::largestAllocation(), 1024 + 20 * bytes.size());
    if (decoded.ok()) {
        ASSERT_TRUE(decode(encode(*decoded)).ok());
    }
}

class Mutation : public ::testing::TestWithParam<std::size_t> {
  protected:
    std::vector<std::byte> bytes_ = encode(samples()[GetParam()]);
};

TEST_P(Mutation, RoundTrip) {
    const Result<Message> decoded = decode(bytes_);
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    EXPECT_EQ(decoded->index(), GetParam());
    EXPECT_EQ(encode(*decoded), bytes_);
}

TEST_P(Mutation, EveryTruncationIsRefused) {
    for (std::size_t size = 0; size < bytes_.size(); ++size) {
        std::vector<std::byte> cut(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_FALSE(decode(cut).ok());
        if (size < kHeaderBytes) continue;
        writeLength(cut);  // an honest length of a message that is too short
        EXPECT_FALSE(decode(cut).ok()) << size;
    }
}

TEST_P(Mutation, RandomChangesAreHarmless) {
    std::mt19937 random(static_cast<unsigned>(1234 + GetParam()));
    const auto upTo = [&](std::size_t most) {
        return std::uniform_int_distribution<std::size_t>(0, most)(random);
    };
    for (int i = 0; i < 20'000; ++i) {
        std::vector<std::byte> changed = bytes_;
        if (upTo(3) == 0) changed.resize(kHeaderBytes + upTo(2 * bytes_.size()));
        for (std::size_t n = upTo(3); n < 4; ++n) {
            constexpr std::byte kLikely[] = {std::byte{0}, std::byte{1}, std::byte{0x7f}, std::byte{0xff}};
            changed[upTo(changed.size() - 1)] =
                upTo(1) == 0 ? kLikely[upTo(3)] : static_cast<std::byte>(upTo(255));
        }
        if (upTo(1) == 0) writeLength(changed);
        ASSERT_NO_FATAL_FAILURE(mustBeHarmless(changed));
    }
}

INSTANTIATE_TEST_SUITE_P(Messages, Mutation, ::testing::Range<std::size_t>(0, std::variant_size_v<Message>));

}  // namespace
}  // namespace iwalk::protocol
