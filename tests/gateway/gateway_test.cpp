#include "server/gateway/gateway.hpp"

#include <gtest/gtest.h>

#include "tests/gateway/raw_client.hpp"

namespace iwalk {
namespace {

using protocol::CameraRequest;
using protocol::Control;
using protocol::FrameDone;
using protocol::TileImage;
using testing::eventually;
using testing::RawClient;

std::unique_ptr<Gateway> open(const Gateway::Limits& limits = {}) {
    auto gateway = Gateway::listen("127.0.0.1", 0, testing::smallWall(), limits);
    EXPECT_TRUE(gateway.ok()) << (gateway.ok() ? "" : gateway.error().message);
    return std::move(gateway).value();
}

CameraRequest awaitRequest(Gateway& gateway) {
    std::optional<CameraRequest> request;
    EXPECT_TRUE(eventually([&] { return (request = gateway.nextRequest()).has_value(); }));
    return request.value_or(CameraRequest{});
}

// By now the gateway has handled all that `client` sent: it answers the end of it.
void finish(RawClient& client) {
    client.send(protocol::Failure{"done"});
    EXPECT_TRUE(client.isDropped());
}

TEST(Gateway, WelcomesAndGivesControlToTheFirst) {
    const auto gateway = open();
    RawClient first(gateway->port());
    ASSERT_TRUE(first.send(protocol::Hello{}));
    const auto message = first.receive();
    ASSERT_TRUE(message);
    EXPECT_EQ(protocol::encode(*message), protocol::encode(testing::smallWall()));
    EXPECT_TRUE(first.receiveA<Control>()->granted);

    RawClient second(gateway->port());
    EXPECT_FALSE(second.greet());
}

TEST(Gateway, NextInLineTakesOverWhenTheControllerIsGone) {
    const auto gateway = open();
    RawClient watcher(gateway->port()), first(gateway->port()), second(gateway->port()),
        third(gateway->port());
    EXPECT_FALSE(watcher.greet(false));
    EXPECT_TRUE(first.greet());
    EXPECT_FALSE(second.greet());
    EXPECT_FALSE(third.greet());
    first.close();
    EXPECT_TRUE(second.receiveA<Control>()->granted);
    second.close();
    EXPECT_TRUE(third.receiveA<Control>()->granted);
    third.sendCamera(5, 0);
    EXPECT_EQ(awaitRequest(*gateway).camera.eye.x, 5);
}

TEST(Gateway, ControlIsHandedOverByASecondHello) {
    const auto gateway = open();
    RawClient first(gateway->port()), second(gateway->port());
    EXPECT_TRUE(first.greet());
    EXPECT_FALSE(second.greet());
    EXPECT_EQ(first.receiveA<Control>()->waiting, 1u);
    first.send(protocol::Hello{protocol::kVersion, false});
    EXPECT_FALSE(first.receiveA<Control>()->granted);
    EXPECT_TRUE(second.receiveA<Control>()->granted);
    first.send(protocol::Hello{protocol::kVersion, true});
    second.send(protocol::Hello{protocol::kVersion, false});
    EXPECT_TRUE(first.receiveA<Control>()->granted);
}

TEST(Gateway, LockstepKeepsOrderAndDrawsNoneTwice) {
    Gateway::Limits limits;
    limits.queuedRequests = 4;  // most of what is sent waits in the socket
    const auto gateway = open(limits);
    RawClient client(gateway->port());
    ASSERT_TRUE(client.greet());
    constexpr std::uint64_t kFrames = 200;
    for (std::uint64_t i = 1; i <= kFrames; ++i) ASSERT_TRUE(client.sendCamera(i, protocol::kLockstep));
    for (std::uint64_t i = 1; i <= kFrames; ++i) {
        const CameraRequest request = awaitRequest(*gateway);
        ASSERT_EQ(request.camera.eye.x, static_cast<double>(i));
        gateway->frameDone({request.sequence, i, 1, {}});
        ASSERT_EQ(client.receiveA<FrameDone>()->sequence, i);
    }
    finish(client);
    EXPECT_FALSE(gateway->nextRequest());
}

TEST(Gateway, ReadingStopsWhileTheQueueIsFull) {
    Gateway::Limits limits;
    limits.queuedRequests = 4;
    const auto gateway = open(limits);
    RawClient client(gateway->port());
    ASSERT_TRUE(client.greet());
    for (std::uint64_t i = 1; i <= 4; ++i) ASSERT_TRUE(client.sendCamera(i, protocol::kLockstep));
    // Were it read now, the connection would end and the four would be forgotten.
    ASSERT_TRUE(client.send(protocol::Failure{"done"}));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(awaitRequest(*gateway).camera.eye.x, 1);
    EXPECT_TRUE(client.isDropped());
    EXPECT_FALSE(gateway->nextRequest() && gateway->nextRequest() && gateway->nextRequest() &&
                 gateway->nextRequest());
}

TEST(Gateway, NewestWinsWithoutLockstep) {
    const auto gateway = open();
    RawClient client(gateway->port());
    ASSERT_TRUE(client.greet());
    for (std::uint64_t i = 1; i <= 50; ++i) ASSERT_TRUE(client.sendCamera(i, 0));
    double last = 0;
    while (last < 50) {
        const CameraRequest request = awaitRequest(*gateway);
        ASSERT_GT(request.camera.eye.x, last);
        last = request.camera.eye.x;
    }
    EXPECT_EQ(last, 50);
    EXPECT_FALSE(gateway->nextRequest());
}

TEST(Gateway, CamerasOfWatchersAreIgnored) {
    const auto gateway = open();
    RawClient controller(gateway->port()), watcher(gateway->port());
    EXPECT_TRUE(controller.greet());
    EXPECT_FALSE(watcher.greet());
    watcher.sendCamera(1, 0);
    watcher.sendCamera(2, protocol::kLockstep);
    finish(watcher);
    EXPECT_FALSE(gateway->nextRequest());
}

TEST(Gateway, RequestsOfAVanishedClientAreDropped) {
    const auto gateway = open();
    RawClient first(gateway->port()), second(gateway->port());
    EXPECT_TRUE(first.greet());
    EXPECT_FALSE(second.greet());
    for (std::uint64_t i = 1; i <= 5; ++i) first.sendCamera(i, protocol::kLockstep);
    EXPECT_EQ(awaitRequest(*gateway).camera.eye.x, 1);
    first.close();
    EXPECT_TRUE(second.receiveA<Control>()->granted);
    EXPECT_FALSE(gateway->nextRequest());
}

TEST(Gateway, FramesGoToAllWithTheRequestersNumber) {
    const auto gateway = open();
    RawClient first(gateway->port()), second(gateway->port());
    EXPECT_TRUE(first.greet());
    EXPECT_FALSE(second.greet());
    first.sendCamera(77, protocol::kLockstep | protocol::kCaptureColor);
    const CameraRequest request = awaitRequest(*gateway);
    EXPECT_NE(request.sequence, 0u);
    gateway->tileImage({request.sequence, 1, protocol::ImageKind::png, {std::byte{9}}});
    gateway->frameDone({request.sequence, 4, 12.5, {{}}});
    gateway->frameDone({0, 5, 13.5, {}});  // nobody asked for this one

    const auto image = first.receiveA<TileImage>();
    ASSERT_TRUE(image);
    EXPECT_EQ(image->sequence, 77u);
    EXPECT_EQ(image->bytes.size(), 1u);
    const auto own = first.receiveA<FrameDone>(), unasked = first.receiveA<FrameDone>();
    EXPECT_EQ(own->sequence, 77u);
    EXPECT_EQ(own->timeMs, 12.5);
    EXPECT_EQ(unasked->sequence, 0u);

    const auto next = second.receive();  // no picture comes before it
    ASSERT_TRUE(next && std::holds_alternative<FrameDone>(*next));
    EXPECT_EQ(std::get<FrameDone>(*next).sequence, 0u);
}

TEST(Gateway, PicturesForAClientThatIsGoneAreDropped) {
    const auto gateway = open();
    RawClient first(gateway->port()), second(gateway->port());
    EXPECT_TRUE(first.greet());
    EXPECT_FALSE(second.greet());
    first.sendCamera(1, protocol::kLockstep | protocol::kCaptureColor);
    const CameraRequest request = awaitRequest(*gateway);
    first.close();
    EXPECT_TRUE(second.receiveA<Control>()->granted);
    gateway->tileImage({request.sequence, 0, protocol::ImageKind::png, std::vector<std::byte>(1000)});
    gateway->frameDone({request.sequence, 1, 1, {}});
    const auto next = second.receive();
    ASSERT_TRUE(next && std::holds_alternative<FrameDone>(*next));
}

TEST(Gateway, CapturesWaitForAClientThatReadsSlowly) {
    Gateway::Limits limits;
    limits.unsentBytes = 256u << 20;
    const auto gateway = open(limits);
    RawClient client(gateway->port());
    ASSERT_TRUE(client.greet());
    for (std::uint64_t i = 1; i <= 2; ++i)
        client.sendCamera(i, protocol::kLockstep | protocol::kCaptureColor);
    const CameraRequest first = awaitRequest(*gateway);
    // More than the kernel's buffers and a quarter of the limit.
    gateway->tileImage({first.sequence, 0, protocol::ImageKind::png, std::vector<std::byte>(80u << 20)});
    for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(gateway->nextRequest());
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_TRUE(client.receiveA<TileImage>());
    EXPECT_EQ(awaitRequest(*gateway).camera.eye.x, 2);
}

TEST(Gateway, PortInUseIsAnErrorThatHelps) {
    const auto gateway = open();
    const auto second = Gateway::listen("127.0.0.1", gateway->port(), testing::smallWall());
    ASSERT_FALSE(second.ok());
    EXPECT_NE(second.error().message.find(fmt::format("127.0.0.1:{}", gateway->port())), std::string::npos);
    EXPECT_NE(second.error().message.find("in use"), std::string::npos);
}

TEST(Gateway, BeyondTheLoopbackATokenIsNeeded) {
    const auto open = Gateway::listen("0.0.0.0", 0, testing::smallWall());
    ASSERT_FALSE(open.ok());
    EXPECT_NE(open.error().message.find("--token-file"), std::string::npos);
    EXPECT_TRUE(Gateway::listen("0.0.0.0", 0, testing::smallWall(), "0123456789abcdef").ok());
    EXPECT_TRUE(Gateway::listen("127.0.0.2", 0, testing::smallWall()).ok());
}

TEST(Gateway, OnlyWhoHasTheTokenGetsIn) {
    const auto gateway = Gateway::listen("127.0.0.1", 0, testing::smallWall(), "0123456789abcdef");
    ASSERT_TRUE(gateway.ok());
    const auto answer = [&](const std::string& token) {
        RawClient client((*gateway)->port());
        client.send(protocol::Hello{protocol::kVersion, true, true, token});
        const auto message = client.receive();
        const auto* failure = message ? std::get_if<protocol::Failure>(&*message) : nullptr;
        EXPECT_TRUE(failure || std::holds_alternative<protocol::Welcome>(*message));
        return failure ? failure->reason : "welcome";
    };
    EXPECT_NE(answer("").find("--token-file"), std::string::npos);
    EXPECT_NE(answer("0123456789abcdeX").find("not the server's token"), std::string::npos);
    EXPECT_FALSE((*gateway)->previewWish().wanted);
    EXPECT_EQ(answer("0123456789abcdef"), "welcome");
}

TEST(Gateway, AddressesThatAreNotHere) {
    EXPECT_FALSE(Gateway::listen("192.0.2.1", 0, testing::smallWall()).ok());
    EXPECT_FALSE(Gateway::listen("not an address", 0, testing::smallWall()).ok());
}

TEST(Gateway, ItsEndTellsTheClients) {
    auto gateway = open();
    RawClient greeted(gateway->port()), silent(gateway->port());
    ASSERT_TRUE(greeted.greet());
    gateway.reset();
    const auto failure = greeted.receiveA<protocol::Failure>();
    ASSERT_TRUE(failure);
    EXPECT_NE(failure->reason.find("shutting down"), std::string::npos);
    EXPECT_TRUE(silent.isDropped());
}

TEST(Gateway, AServerStartsAgainOnItsPort) {
    auto gateway = open();
    const std::uint16_t port = gateway->port();
    RawClient client(port);
    ASSERT_TRUE(client.greet());
    gateway.reset();
    EXPECT_TRUE(Gateway::listen("127.0.0.1", port, testing::smallWall()).ok());
}

}  // namespace
}  // namespace iwalk
