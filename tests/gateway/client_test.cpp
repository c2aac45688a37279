#include "client/client.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <future>
#include <numeric>

#include "client/wall_check.hpp"
#include "common/camera_path.hpp"
#include "tests/gateway/fake_wall.hpp"
#include "tests/gateway/raw_client.hpp"

namespace iwalk::client {
namespace {

using testing::FakeWall;

// Playback of a path of `frames` cameras with eye.x 0, 1, 2...
class ClientPlayback : public ::testing::Test {
  protected:
    ClientPlayback() { std::filesystem::create_directories(directory_); }
    ~ClientPlayback() override { std::filesystem::remove_all(directory_); }

    Options options(const FakeWall& wall, int frames) { return options(wall.port(), frames); }
    Options options(std::uint16_t port, int frames) {
        std::vector<Camera> path(static_cast<std::size_t>(frames));
        for (std::size_t i = 0; i < path.size(); ++i)
            path[i].eye.x = path[i].target.x = static_cast<double>(i);
        Options options;
        options.server = {"127.0.0.1", port};
        options.path = directory_ + "/path.json";
        EXPECT_TRUE(saveCameraPath(options.path, path).ok());
        return options;
    }
    static std::string failure(const Options& options) {
        const auto done = run(options, nullptr);
        return done.ok() ? "" : done.error().message;
    }

    const std::string directory_ = ::testing::TempDir() + "iwalk-client-" +
                                   ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(ClientPlayback, LockstepDrawsEveryFrameOnce) {
    FakeWall wall;
    std::size_t shown = 0;
    const auto done = run(options(wall, 100), [&](std::size_t played, std::size_t) { shown = played; });
    ASSERT_TRUE(done.ok()) << done.error().message;
    std::vector<double> expected(100);
    std::iota(expected.begin(), expected.end(), 0.0);
    EXPECT_EQ(wall.drawn(), expected);
    EXPECT_EQ(shown, 100u);
    EXPECT_EQ(*done, "100 of 100 frames, 60.0 ms median, 108.0 ms p99");
}

TEST_F(ClientPlayback, RealtimeGoesForwardToTheLastFrame) {
    FakeWall wall({.frameTime = std::chrono::milliseconds(5)});
    Options realtime = options(wall, 200);
    realtime.pace = Pace::realtime;
    realtime.fps = 1000;
    const auto done = run(realtime, nullptr);
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_NE(done->find("camera to swap"), std::string::npos);
    const std::vector<double> drawn = wall.drawn();
    ASSERT_FALSE(drawn.empty());
    EXPECT_TRUE(std::is_sorted(drawn.begin(), drawn.end()));
    EXPECT_EQ(std::adjacent_find(drawn.begin(), drawn.end()), drawn.end());
    EXPECT_EQ(drawn.back(), 199);
}

TEST_F(ClientPlayback, RealtimeCaptures) {
    FakeWall wall;
    Options realtime = options(wall, 20);
    realtime.pace = Pace::realtime;
    realtime.fps = 500;
    realtime.captureDir = directory_ + "/out";
    const auto done = run(realtime, nullptr);
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_TRUE(std::filesystem::exists(realtime.captureDir + "/frame-000019/wall.png"));
}

TEST_F(ClientPlayback, AServerThatVanishesIsAnError) {
    FakeWall wall({.vanishAfter = 5});
    const std::string message = failure(options(wall, 50));
    // Either its good-bye or the bare end of the connection, whichever the network let through.
    EXPECT_NE(message.find("the server at 127.0.0.1"), std::string::npos) << message;
}

TEST_F(ClientPlayback, NoServerIsAnErrorAfterTheTimeout) {
    Options lonely = options(1, 1);
    lonely.timeoutSeconds = 0.3;
    EXPECT_NE(failure(lonely).find("cannot reach a server at 127.0.0.1:1"), std::string::npos);
    lonely.server.host = "no-such-host.invalid";
    EXPECT_NE(failure(lonely).find("cannot find the host"), std::string::npos);
}

TEST_F(ClientPlayback, ControlOfAnotherClientIsAnErrorAfterTheTimeout) {
    FakeWall wall;
    testing::RawClient other(wall.port());
    ASSERT_TRUE(other.greet());
    Options second = options(wall, 3);
    second.timeoutSeconds = 0.3;
    EXPECT_NE(failure(second).find("another client controls"), std::string::npos);
    other.close();
    second.timeoutSeconds = 20;
    EXPECT_EQ(failure(second), "");
}

TEST_F(ClientPlayback, WaitsForAServerThatStartsLater) {
    std::uint16_t port = 0;
    {
        const FakeWall wall;
        port = wall.port();
    }
    Options early = options(port, 1);
    early.timeoutSeconds = 20;
    auto playing = std::async(std::launch::async, [&] { return failure(early); });
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    auto gateway = Gateway::listen("127.0.0.1", port, testing::smallWall());
    ASSERT_TRUE(gateway.ok());
    ASSERT_TRUE(testing::eventually([&] {
        const auto request = (*gateway)->nextRequest();
        if (request) (*gateway)->frameDone({request->sequence, 1, 1, {}});
        return request.has_value();
    }));
    EXPECT_EQ(playing.get(), "");
}

TEST_F(ClientPlayback, BrokenPathsAreErrors) {
    FakeWall wall;
    Options broken = options(wall, 1);
    broken.path = directory_ + "/nothing.json";
    EXPECT_NE(failure(broken).find("nothing.json"), std::string::npos);
}

TEST_F(ClientPlayback, AReportThatCannotBeWrittenFailsBeforeThePath) {
    FakeWall wall;
    Options report = options(wall, 3);
    report.report = directory_ + "/missing/report.json";
    EXPECT_NE(failure(report).find("report.json"), std::string::npos);
    EXPECT_TRUE(wall.drawn().empty());
}

TEST(ParseAddress, Forms) {
    EXPECT_EQ(parseAddress("wall:4242")->host, "wall");
    EXPECT_EQ(parseAddress("wall:4242")->port, 4242);
    EXPECT_EQ(parseAddress("[::1]:1")->host, "::1");
    for (const char* bad :
         {"", "wall", ":1", "wall:", "wall:0", "wall:65536", "wall:x", "::1:4", "wall:-1", "wall:1 "}) {
        EXPECT_FALSE(parseAddress(bad).ok()) << bad;
    }
}

TEST(WallCheck, HostileWallsAreRefused) {
    EXPECT_TRUE(checkWall(testing::smallWall()).ok());
    for (const char* name : {"", ".", "..", ".hidden", "../up", "a/b", "wall", "a b", "-\n", "ä", "a\\b"}) {
        protocol::Welcome welcome = testing::smallWall();
        welcome.tiles[1].name = name;
        EXPECT_FALSE(checkWall(welcome).ok()) << name;
    }
    protocol::Welcome twins = testing::smallWall();
    twins.tiles[1].name = twins.tiles[0].name;
    EXPECT_FALSE(checkWall(twins).ok());
    protocol::Welcome outside = testing::smallWall();
    outside.tiles[1].x = 21;
    EXPECT_FALSE(checkWall(outside).ok());
    outside.tiles[1].x = -1;
    EXPECT_FALSE(checkWall(outside).ok());
    protocol::Welcome huge = testing::smallWall();
    huge.wallWidth = huge.wallHeight = 1 << 20;
    EXPECT_FALSE(checkWall(huge).ok());
    protocol::Welcome free = testing::smallWall();
    free.wallWidth = free.wallHeight = 0;
    EXPECT_TRUE(checkWall(free).ok());
    protocol::Welcome none = testing::smallWall();
    none.tiles.clear();
    EXPECT_FALSE(checkWall(none).ok());
}

}  // namespace
}  // namespace iwalk::client
