#include "common/protocol.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace iwalk::protocol {
namespace {

std::string hex(const std::vector<std::byte>& bytes) {
    std::string text;
    for (const std::byte b : bytes) text += fmt::format("{:02x}", std::to_integer<int>(b));
    return text;
}

Result<Message> decode(const std::vector<std::byte>& bytes, std::uint32_t limit = kMaxServerPayload) {
    const std::span all(bytes);
    ASSIGN_OR_RETURN(const Header header, decodeHeader(all.first<kHeaderBytes>(), limit));
    return decodePayload(header, all.subspan(kHeaderBytes));
}

template <class T>
T roundTrip(const T& message) {
    const Result<Message> decoded = decode(encode(message));
    EXPECT_TRUE(decoded.ok()) << (decoded.ok() ? "" : decoded.error().message);
    const T* same = decoded.ok() ? std::get_if<T>(&*decoded) : nullptr;
    EXPECT_NE(same, nullptr);
    return same ? *same : T{};
}

std::string refusal(const std::vector<std::byte>& bytes) {
    const Result<Message> decoded = decode(bytes);
    return decoded.ok() ? "" : decoded.error().message;
}

TEST(Protocol, GoldenBytes) {
    EXPECT_EQ(hex(encode(Hello{})),
              "0800000001000000040000000100"
              "0000");
    EXPECT_EQ(hex(encode(Hello{kVersion, false, true, "key"})),
              "0b00000001000000040000000001"
              "03006b6579");
    EXPECT_EQ(hex(encode(Control{true, 2})), "05000000040000000102000000");
    EXPECT_EQ(hex(encode(ChangeSettings{{{"near", "1"}}})),
              "0d00000008000000"
              "01000000"
              "04006e656172"
              "010031");
    EXPECT_EQ(hex(encode(SettingsNow{{}, "no"})),
              "0800000009000000"
              "00000000"
              "02006e6f");
    EXPECT_EQ(hex(encode(Failure{"no"})), "040000000700000002006e6f");

    CameraRequest request{3, kLockstep | kCaptureColor, {}};
    EXPECT_EQ(hex(encode(request)),
              "5900000002000000"
              "0300000000000000"
              "03"
              "000000000000000000000000000000000000000000000000"
              "00000000000000000000000000000000000000000000f0bf"
              "0000000000000000000000000000f03f0000000000000000"
              "0000000000004e40");

    TileImage image{7, 2, ImageKind::exr, {std::byte{0xab}}};
    EXPECT_EQ(hex(encode(image)),
              "1200000006000000"
              "0700000000000000"
              "02000000"
              "01"
              "01000000"
              "ab");
}

TEST(Protocol, CameraRequestRoundTrip) {
    const CameraRequest request{42, kCaptureDepth, {{1.5, -2e9, 3}, {4, 5, 6}, {0, 0, 1}, 33.25}};
    const CameraRequest same = roundTrip(request);
    EXPECT_EQ(same.sequence, 42u);
    EXPECT_EQ(same.flags, kCaptureDepth);
    EXPECT_EQ(same.camera, request.camera);
}

TEST(Protocol, WelcomeRoundTrip) {
    Welcome welcome{kVersion, "1.2.3", 5'000'000'000, 77, {}, 200, 100, {}, {{"cache", "1G"}}};
    welcome.bounds.add(glm::dvec3(-1, 2, 3));
    welcome.tiles.push_back({"tile-0-0", "höst", 3, -5, 6, 100, 50});
    const Welcome same = roundTrip(welcome);
    EXPECT_EQ(same.serverVersion, "1.2.3");
    EXPECT_EQ(same.datasetTriangles, 5'000'000'000u);
    EXPECT_EQ(same.bounds, welcome.bounds);
    ASSERT_EQ(same.tiles.size(), 1u);
    EXPECT_EQ(same.tiles[0].host, "höst");
    EXPECT_EQ(same.tiles[0].x, -5);
    ASSERT_EQ(same.settings.size(), 1u);
    EXPECT_EQ(same.settings[0].value, "1G");
}

TEST(Protocol, FrameDoneRoundTrip) {
    FrameDone done{9, 10, 16.5, {{}, {}}, {{1, 2, 3}, {4, 5, 6}, {0, 0, 1}, 50}, 2.25};
    done.tiles[1] = {.tile = 1,
                     .guessMs = 2.5,
                     .pyramidMs = 3.5,
                     .testMs = 4.5,
                     .triangles = 6,
                     .guessTriangles = 7,
                     .hiddenPages = 9,
                     .hiddenRanges = 10,
                     .screenErrorPx = 8.5,
                     .badPages = 12,
                     .peakRssBytes = 13,
                     .nearDepth = 14.5,
                     .midDepth = 15.5};
    const FrameDone same = roundTrip(done);
    EXPECT_EQ(same.timeMs, 16.5);
    ASSERT_EQ(same.tiles.size(), 2u);
    EXPECT_EQ(same.tiles[1].guessMs, 2.5);
    EXPECT_EQ(same.tiles[1].pyramidMs, 3.5);
    EXPECT_EQ(same.tiles[1].testMs, 4.5);
    EXPECT_EQ(same.tiles[1].triangles, 6u);
    EXPECT_EQ(same.tiles[1].guessTriangles, 7u);
    EXPECT_EQ(same.tiles[1].hiddenPages, 9u);
    EXPECT_EQ(same.tiles[1].hiddenRanges, 10u);
    EXPECT_EQ(same.tiles[1].screenErrorPx, 8.5);
    EXPECT_EQ(same.tiles[1].badPages, 12u);
    EXPECT_EQ(same.tiles[1].peakRssBytes, 13u);
    EXPECT_EQ(same.tiles[1].nearDepth, 14.5);
    EXPECT_EQ(same.tiles[1].midDepth, 15.5);
    EXPECT_EQ(same.camera, done.camera);
}

TEST(Protocol, SettingsRoundTrip) {
    const SettingsNow same = roundTrip(SettingsNow{{{"mode", "plp"}, {"near", "0.5"}}, "größer"});
    ASSERT_EQ(same.settings.size(), 2u);
    EXPECT_EQ(same.settings[1].name, "near");
    EXPECT_EQ(same.settings[1].value, "0.5");
    EXPECT_EQ(same.refusal, "größer");
    ASSERT_EQ(roundTrip(ChangeSettings{{{"mode", "plp"}}}).settings.size(), 1u);
}

TEST(Protocol, TileImageRoundTrip) {
    TileImage image{1, 4095, ImageKind::png, std::vector<std::byte>(100'000, std::byte{5})};
    const TileImage same = roundTrip(image);
    EXPECT_EQ(same.tile, 4095u);
    EXPECT_EQ(same.bytes, image.bytes);
}

TEST(Protocol, HeaderRefusals) {
    std::vector<std::byte> bytes = encode(Hello{});
    EXPECT_TRUE(decode(bytes, 8).ok());
    EXPECT_FALSE(decode(bytes, 7).ok());
    bytes[4] = std::byte{10};
    EXPECT_FALSE(decode(bytes).ok());
    bytes[4] = std::byte{0};
    EXPECT_FALSE(decode(bytes).ok());
    bytes[4] = std::byte{1};
    bytes[6] = std::byte{1};
    EXPECT_FALSE(decode(bytes).ok());
}

TEST(Protocol, OtherVersionIsNamed) {
    EXPECT_NE(refusal(encode(Hello{1, true})).find("version 1"), std::string::npos);
    Welcome welcome;
    welcome.version = 77;
    EXPECT_NE(refusal(encode(welcome)).find("version 77"), std::string::npos);
}

TEST(Protocol, TrailingBytesRefused) {
    std::vector<std::byte> bytes = encode(Hello{});
    bytes.push_back(std::byte{0});
    bytes[0] = std::byte{9};
    EXPECT_NE(refusal(bytes).find("after the end"), std::string::npos);
}

TEST(Protocol, NotANumberRefused) {
    std::vector<std::byte> bytes = encode(CameraRequest{1, 0, {}});
    for (const std::byte high : {std::byte{0x7f}, std::byte{0xff}}) {
        std::vector<std::byte> bad = bytes;
        bad[kHeaderBytes + 9 + 6] = std::byte{0xf0};  // the top of eye.x: infinity, and its negative
        bad[kHeaderBytes + 9 + 7] = high;
        EXPECT_NE(refusal(bad).find("finite"), std::string::npos);
        bad[kHeaderBytes + 9 + 6] = std::byte{0xf8};  // NaN
        EXPECT_NE(refusal(bad).find("finite"), std::string::npos);
    }
}

TEST(Protocol, ImpossibleCamerasRefused) {
    std::vector<std::byte> bytes = encode(CameraRequest{1, 0, {}});
    std::vector<std::byte> noSequence = bytes;
    noSequence[kHeaderBytes] = std::byte{0};
    EXPECT_FALSE(decode(noSequence).ok());
    std::vector<std::byte> unknownFlag = bytes;
    unknownFlag[kHeaderBytes + 8] = std::byte{8};
    EXPECT_FALSE(decode(unknownFlag).ok());
    std::vector<std::byte> eyeAtTarget = bytes;
    std::fill_n(eyeAtTarget.begin() + kHeaderBytes + 9, 48, std::byte{0});
    EXPECT_NE(refusal(eyeAtTarget).find("eye"), std::string::npos);
}

TEST(Protocol, CountsBeyondThePayloadRefused) {
    std::vector<std::byte> bytes = encode(FrameDone{1, 1, 0, {TileStats{}}});
    bytes[kHeaderBytes + 112] = std::byte{2};  // two tiles in the bytes of one
    EXPECT_NE(refusal(bytes).find("items"), std::string::npos);
    bytes[kHeaderBytes + 115] = std::byte{0xff};
    EXPECT_NE(refusal(bytes).find("items"), std::string::npos);
}

TEST(Protocol, TextIsMadeToFit) {
    EXPECT_EQ(roundTrip(Failure{"a\nb\x1b[31m\xff\xc0\x80z\x7f"}).reason, "a?b?[31m???z?");
    EXPECT_EQ(roundTrip(Failure{std::string(5000, 'x')}).reason.size(), kMaxStringBytes);
    // A character is never cut in two.
    EXPECT_EQ(roundTrip(Failure{std::string(kMaxStringBytes - 1, 'x') + "é"}).reason.size(),
              kMaxStringBytes - 1);
    EXPECT_EQ(roundTrip(Failure{"grün 墙 🧱"}).reason, "grün 墙 🧱");
}

TEST(Protocol, TextThatIsNoneRefused) {
    for (const char* bad :
         {"\x80", "\xc1\xbf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xc2\x85", "\n"}) {
        std::vector<std::byte> bytes = encode(Failure{std::string(std::string_view(bad).size(), 'x')});
        const auto text = std::as_bytes(std::span(std::string_view(bad)));
        std::copy(text.begin(), text.end(), bytes.begin() + kHeaderBytes + 2);
        EXPECT_NE(refusal(bytes).find("UTF-8"), std::string::npos) << hex(bytes);
    }
}

TEST(ProtocolDeathTest, OurOwnBugsAreNotSent) {
    FrameDone done;
    done.timeMs = std::numeric_limits<double>::quiet_NaN();
    EXPECT_DEATH(encode(done), "isfinite");
}

}  // namespace
}  // namespace iwalk::protocol
