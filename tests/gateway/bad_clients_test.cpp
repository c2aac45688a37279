#include <dirent.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>

#include <random>

#include "server/gateway/gateway.hpp"
#include "tests/gateway/raw_client.hpp"

// Clients that misbehave are dropped, and told why where that is possible; the others notice nothing.
namespace iwalk {
namespace {

using protocol::Control;
using protocol::Failure;
using protocol::FrameDone;
using std::chrono::milliseconds;
using testing::eventually;
using testing::RawClient;

class BadClients : public ::testing::Test {
  protected:
    void open(const Gateway::Limits& limits = {}) {
        auto gateway = Gateway::listen("127.0.0.1", 0, testing::smallWall(), limits);
        ASSERT_TRUE(gateway.ok()) << gateway.error().message;
        gateway_ = std::move(gateway).value();
    }
    RawClient connect() { return RawClient(gateway_->port()); }

    // One frame there and back for a client that controls.
    void expectFrames(RawClient& client, std::uint32_t tiles = 0) {
        ASSERT_TRUE(client.sendCamera(++sequence_, protocol::kLockstep));
        std::optional<protocol::CameraRequest> request;
        ASSERT_TRUE(eventually([&] { return (request = gateway_->nextRequest()).has_value(); }));
        gateway_->frameDone({request->sequence, 1, 1, std::vector<protocol::TileStats>(tiles)});
        const auto done = client.receiveA<FrameDone>();
        ASSERT_TRUE(done);
        ASSERT_EQ(done->sequence, sequence_);
    }
    static std::string reason(RawClient& client) {
        const auto failure = client.receiveA<Failure>();
        EXPECT_TRUE(client.isDropped());
        return failure ? failure->reason : "";
    }

    std::unique_ptr<Gateway> gateway_;
    std::uint64_t sequence_ = 0;
};

// What is allocated by this process.
std::size_t heapBytes() {
    const struct mallinfo2 info = ::mallinfo2();
    return info.uordblks + info.hblkhd;
}

int openDescriptors() {
    int count = 0;
    DIR* directory = ::opendir("/proc/self/fd");
    while (::readdir(directory) != nullptr) ++count;
    ::closedir(directory);
    return count;
}

TEST_F(BadClients, GarbageIsDroppedWhileOthersGoOn) {
    open();
    RawClient good = connect();
    ASSERT_TRUE(good.greet());
    std::mt19937 random(7);
    for (int i = 0; i < 20; ++i) {
        RawClient bad = connect();
        std::vector<std::byte> garbage(5000);
        for (std::byte& b : garbage) b = static_cast<std::byte>(random() & 0xff);
        bad.sendBytes(garbage);
        EXPECT_NE(reason(bad), "");
        expectFrames(good);
    }
}

TEST_F(BadClients, WebBrowsersAreToldSo) {
    open();
    RawClient browser = connect();
    browser.sendBytes(std::as_bytes(std::span(std::string_view("GET / HTTP/1.1\r\nHost: wall\r\n\r\n"))));
    EXPECT_NE(reason(browser).find("protocol"), std::string::npos);
}

TEST_F(BadClients, MessagesOutOfPlace) {
    open();
    RawClient early = connect();
    early.sendCamera(1, 0);
    EXPECT_NE(reason(early).find("before the Hello"), std::string::npos);

    RawClient wrong = connect();
    ASSERT_TRUE(wrong.greet());
    wrong.send(Control{true});
    EXPECT_NE(reason(wrong).find("only servers"), std::string::npos);

    RawClient large = connect();
    large.send(protocol::TileImage{1, 0, protocol::ImageKind::png, std::vector<std::byte>(2000)});
    EXPECT_NE(reason(large).find("limit"), std::string::npos);

    RawClient old = connect();
    old.send(protocol::Hello{99, true});
    EXPECT_NE(reason(old).find("version 99"), std::string::npos);
}

TEST_F(BadClients, SilenceIsDropped) {
    Gateway::Limits limits;
    limits.helloTimeout = milliseconds(500);  // time for the good client, also on a busy machine
    open(limits);
    RawClient silent = connect(), half = connect();
    const std::vector<std::byte> hello = protocol::encode(protocol::Hello{});
    half.sendBytes(std::span(hello).first(5));
    EXPECT_NE(reason(silent).find("Hello"), std::string::npos);
    EXPECT_NE(reason(half).find("Hello"), std::string::npos);

    RawClient good = connect();
    ASSERT_TRUE(good.greet());
    std::this_thread::sleep_for(milliseconds(600));  // a greeted client may be silent for as long as it likes
    expectFrames(good);
}

TEST_F(BadClients, OneByteAtATimeIsFine) {
    open();
    RawClient slow = connect();
    const auto trickle = [&](const protocol::Message& message) {
        for (const std::byte b : protocol::encode(message)) {
            ASSERT_TRUE(slow.sendBytes(std::span(&b, 1)));
            std::this_thread::sleep_for(std::chrono::microseconds(200));
        }
    };
    trickle(protocol::Hello{});
    EXPECT_TRUE(slow.receiveA<Control>()->granted);
    trickle(protocol::CameraRequest{1, protocol::kLockstep, {}});
    EXPECT_TRUE(eventually([&] { return gateway_->nextRequest().has_value(); }));
}

TEST_F(BadClients, AReaderWithTooMuchUnsentIsDropped) {
    Gateway::Limits limits;
    limits.unsentBytes = 2u << 20;
    open(limits);
    RawClient good = connect(), slow = connect();
    ASSERT_TRUE(good.greet());
    ASSERT_FALSE(slow.greet());
    constexpr int kFrames = 100;  // of 450 KB: far more than the limit and the kernel's buffers together
    for (int i = 0; i < kFrames; ++i) expectFrames(good, protocol::kMaxTiles);
    int received = 0;
    while (slow.receiveA<FrameDone>()) ++received;
    EXPECT_LT(received, kFrames);
    expectFrames(good);
}

TEST_F(BadClients, AReaderThatTakesNothingIsDropped) {
    Gateway::Limits limits;
    limits.stallTimeout = milliseconds(200);
    open(limits);
    RawClient stalled = connect(), next = connect();
    ASSERT_TRUE(stalled.greet());
    ASSERT_FALSE(next.greet());
    stalled.sendCamera(1, protocol::kLockstep | protocol::kCaptureColor);
    std::optional<protocol::CameraRequest> request;
    ASSERT_TRUE(eventually([&] { return (request = gateway_->nextRequest()).has_value(); }));
    gateway_->tileImage({request->sequence, 0, protocol::ImageKind::png, std::vector<std::byte>(32u << 20)});
    EXPECT_TRUE(next.receiveA<Control>()->granted);
    expectFrames(next);
}

TEST_F(BadClients, OneTooManyIsTurnedAway) {
    open();
    std::vector<RawClient> clients;
    for (int i = 0; i < Gateway::kMaxClients; ++i) {
        clients.push_back(connect());
        EXPECT_EQ(clients.back().greet(), i == 0);
    }
    RawClient tooMany = connect();
    EXPECT_NE(reason(tooMany).find("32 clients"), std::string::npos);
    clients[5].close();
    ASSERT_TRUE(eventually([&] {
        RawClient again = connect();
        again.send(protocol::Hello{});
        return again.receiveA<protocol::Welcome>().has_value();
    }));
    expectFrames(clients[0]);
}

// One that trickles its messages holds nobody up: all frames of the other come while it has said half.
TEST_F(BadClients, ASlowTalkerDelaysNoFrame) {
    Gateway::Limits limits;
    limits.helloTimeout = std::chrono::minutes(2);
    open(limits);
    RawClient good = connect(), slow = connect();
    ASSERT_TRUE(good.greet());
    const std::vector<std::byte> hello = protocol::encode(protocol::Hello{});
    for (const std::byte& b : hello) {
        ASSERT_TRUE(slow.sendBytes(std::span(&b, 1)));
        for (int i = 0; i < 5; ++i) expectFrames(good);
    }
    EXPECT_FALSE(slow.receiveA<Control>()->granted);  // it was heard, too
}

TEST_F(BadClients, ComingAndGoingLeavesNothingBehind) {
    open();
    RawClient good = connect();
    ASSERT_TRUE(good.greet());
    const int before = openDescriptors();
    const auto visits = [&](int count) {
        for (int i = 0; i < count; ++i) {
            // Late clients may be turned away while early ones are still being noticed as gone: that is part
            // of it.
            RawClient visitor = connect();
            if (i % 3 == 1) visitor.send(protocol::Hello{});
            if (i % 3 == 2) visitor.sendBytes(std::vector<std::byte>(100, std::byte{0xff}));
        }
        EXPECT_TRUE(eventually([&] { return openDescriptors() <= before; }));
    };
    visits(200);
    const std::size_t settled = heapBytes();
    visits(1000);
    expectFrames(good);
    // A connection that stayed would keep its buffers, more than a kilobyte of them.
    EXPECT_LT(heapBytes(), settled + 300'000);
}

TEST_F(BadClients, OutOfDescriptorsIsSurvived) {
    open();
    RawClient good = connect();
    ASSERT_TRUE(good.greet());
    rlimit saved{};
    ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &saved), 0);
    // Room for the client's end of the next connection and none for the gateway's.
    rlimit tight = saved;
    const int next = ::dup(0);
    ::close(next);
    tight.rlim_cur = static_cast<rlim_t>(next) + 1;
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &tight), 0);
    RawClient waiting = connect();
    for (int i = 0; i < 10; ++i) expectFrames(good);
    std::this_thread::sleep_for(milliseconds(300));
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &saved), 0);
    waiting.greet();
    expectFrames(good);
}

}  // namespace
}  // namespace iwalk
