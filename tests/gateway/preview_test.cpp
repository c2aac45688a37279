#include <gtest/gtest.h>

#include "server/gateway/gateway.hpp"
#include "server/gateway/preview_pace.hpp"
#include "tests/gateway/raw_client.hpp"

// Small pictures of the wall: who gets them, and how many there are.
namespace iwalk {
namespace {

using protocol::Hello;
using protocol::ImageKind;
using protocol::TileImage;
using testing::eventually;
using testing::RawClient;

constexpr std::uint64_t kMuch = 1'000'000'000;

PreviewPace::Time at(double seconds) {
    return PreviewPace::Time(std::chrono::hours(1)) +
           std::chrono::duration_cast<PreviewPace::Time::duration>(std::chrono::duration<double>(seconds));
}

TEST(PreviewPace, NotOftenerThanAskedFor) {
    PreviewPace pace;
    int made = 0;
    for (double t = 0; t < 10; t += 0.01) {
        pace.somethingNew();
        if (!pace.due(at(t), 5)) continue;
        ++made;
        pace.begin(at(t), 2);
        pace.arrived(1000, 5, kMuch), pace.arrived(1000, 5, kMuch);
    }
    EXPECT_NEAR(made, 50, 3);
}

TEST(PreviewPace, NotMoreBytesThanAskedFor) {
    PreviewPace pace;
    std::uint64_t bytes = 0;
    for (double t = 0; t < 10; t += 0.01) {
        pace.somethingNew();
        if (!pace.due(at(t), 30)) continue;
        pace.begin(at(t), 1);
        pace.arrived(50'000, 30, 100'000);
        bytes += 50'000;
    }
    EXPECT_LE(bytes, 10u * 100'000 + 50'000);
    EXPECT_GE(bytes, 9u * 100'000);
}

TEST(PreviewPace, NoneWhileTilesAreOutstandingOrNothingIsNew) {
    PreviewPace pace;
    EXPECT_FALSE(pace.due(at(0), 5));
    pace.somethingNew();
    EXPECT_FALSE(pace.due(at(0), 0));  // switched off
    EXPECT_TRUE(pace.due(at(0), 5));
    pace.begin(at(0), 2);
    pace.somethingNew();
    EXPECT_FALSE(pace.due(at(100), 5));
    pace.arrived(10, 5, kMuch);
    EXPECT_FALSE(pace.due(at(100), 5));
    pace.arrived(0, 5, kMuch);
    EXPECT_TRUE(pace.due(at(100), 5));
    pace.begin(at(100), 1);
    pace.arrived(10, 5, kMuch);
    EXPECT_FALSE(pace.due(at(200), 5));  // seen already
}

class Previews : public ::testing::Test {
  protected:
    Previews() {
        auto gateway = Gateway::listen("127.0.0.1", 0, testing::smallWall());
        EXPECT_TRUE(gateway.ok());
        gateway_ = std::move(gateway).value();
    }
    RawClient connect(bool preview) {
        RawClient client(gateway_->port());
        client.send(Hello{protocol::kVersion, true, preview, {}});
        EXPECT_TRUE(client.receiveA<protocol::Control>());
        return client;
    }
    void give(std::uint32_t tile, std::size_t bytes) {
        gateway_->tileImage({42, tile, ImageKind::preview, std::vector<std::byte>(bytes, std::byte{7})});
    }
    std::unique_ptr<Gateway> gateway_;
};

TEST_F(Previews, GoToWhoWantsThem) {
    EXPECT_FALSE(gateway_->previewWish().wanted);
    RawClient without = connect(false), with = connect(true);
    EXPECT_TRUE(gateway_->previewWish().wanted);
    EXPECT_EQ(gateway_->previewWish().joined, 1u);
    give(1, 500);
    const auto picture = with.receiveA<TileImage>();
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->kind, ImageKind::preview);
    EXPECT_EQ(picture->tile, 1u);
    EXPECT_EQ(picture->sequence, 42u);
    EXPECT_EQ(picture->bytes.size(), 500u);
    gateway_->frameDone({0, 1, 1, {}});
    const auto next = without.receiveA<protocol::FrameDone>();
    ASSERT_TRUE(next);

    with.send(Hello{protocol::kVersion, true, false, {}});  // enough
    ASSERT_TRUE(eventually([&] { return !gateway_->previewWish().wanted; }));
    without.send(Hello{protocol::kVersion, true, true, {}});  // now this one
    ASSERT_TRUE(eventually([&] { return gateway_->previewWish().wanted; }));
    EXPECT_EQ(gateway_->previewWish().joined, 2u);
    give(0, 100);
    EXPECT_EQ(without.receiveA<TileImage>()->tile, 0u);
    without.close();
    EXPECT_TRUE(eventually([&] { return !gateway_->previewWish().wanted; }));
}

TEST_F(Previews, AreDroppedForWhoDoesNotReadThem) {
    RawClient slow = connect(true);
    constexpr std::size_t kBytes = 100'000, kPictures = 400;
    for (std::size_t i = 0; i < kPictures; ++i) give(static_cast<std::uint32_t>(i % 2), kBytes);
    gateway_->frameDone({0, 9, 1, {}});
    std::size_t received = 0;
    for (;;) {
        const auto message = slow.receive();
        ASSERT_TRUE(message);
        if (std::holds_alternative<protocol::FrameDone>(*message)) break;
        received += std::holds_alternative<TileImage>(*message) ? 1 : 0;
    }
    EXPECT_GE(received, 2u);
    EXPECT_LT(received, kPictures / 2);  // 40 MB; the kernel's buffers and ours take a part of it
    give(0, 1000);                       // who reads on gets the next ones
    EXPECT_TRUE(slow.receiveA<TileImage>());
}

}  // namespace
}  // namespace iwalk
