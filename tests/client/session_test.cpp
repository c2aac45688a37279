#include "client/fly/session.hpp"

#include <gtest/gtest.h>

#include "tests/gateway/fake_wall.hpp"
#include "tests/gateway/raw_client.hpp"

namespace iwalk::client {
namespace {

using testing::eventually;
using testing::FakeWall;
using testing::RawClient;

Camera at(double x) {
    return {{x, 0, 0}, {x, 0, -1}, {0, 1, 0}, 60};
}

std::string valueOf(const WallState& state, const std::string& name) {
    for (const protocol::NamedValue& setting : state.settings)
        if (setting.name == name) return setting.value;
    return "none";
}

class SessionTest : public ::testing::Test {
  protected:
    Session& start(std::uint16_t port) {
        return session_.emplace(Address{"127.0.0.1", port}, protocol::Hello{}, [this] { ++news_; });
    }
    std::optional<Session> session_;
    std::atomic<int> news_{0};
};

TEST_F(SessionTest, SendsTheNewestCameraAndMeasures) {
    FakeWall wall({.frameTime = std::chrono::milliseconds(3)});
    Session& session = start(wall.port());
    ASSERT_TRUE(eventually([&] { return session.state().control; }));
    EXPECT_EQ(session.state().welcome->tiles.size(), 2u);
    for (int i = 1; i <= 100; ++i) {
        session.setCamera(at(i));
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(eventually([&] {
        const auto frame = session.state().frame;
        return frame && frame->camera.eye.x == 100;
    }));
    const WallState state = session.state();
    EXPECT_GE(state.latency.median, 3);
    EXPECT_GT(state.framesPerSecond, 0);
    EXPECT_GT(state.interval.median, 0);
    EXPECT_GT(news_, 2);
    EXPECT_EQ(state.trouble, "");
    EXPECT_TRUE(std::ranges::is_sorted(wall.drawn()));
}

TEST_F(SessionTest, ServersThatComeAgainGetCameraAndSettings) {
    auto wall = std::make_unique<FakeWall>();
    const std::uint16_t port = wall->port();
    Session& session = start(port);
    session.setCamera(at(5));
    session.changeSetting("mode", "plp");
    ASSERT_TRUE(eventually([&] { return valueOf(session.state(), "mode") == "plp"; }));
    ASSERT_TRUE(eventually([&] { return session.state().frame != nullptr; }));

    wall.reset();
    ASSERT_TRUE(eventually([&] { return !session.state().connected; }));
    EXPECT_NE(session.state().trouble, "");
    session.setCamera(at(6));  // meanwhile
    wall = std::make_unique<FakeWall>(FakeWall::Behaviour{}, protocol::Welcome{}, port);
    ASSERT_TRUE(eventually([&] { return !wall->drawn().empty(); }));
    EXPECT_EQ(wall->drawn(), std::vector<double>{6});
    EXPECT_EQ(wall->modes(), std::vector<Mode>{Mode::plp});
    ASSERT_TRUE(eventually([&] { return valueOf(session.state(), "mode") == "plp"; }));
    EXPECT_EQ(session.state().trouble, "");
}

TEST_F(SessionTest, SaysWhyThereIsNoServer) {
    Session& session = start(1);
    ASSERT_TRUE(eventually([&] { return !session.state().trouble.empty(); }));
    EXPECT_NE(session.state().trouble.find("127.0.0.1:1"), std::string::npos);
}

TEST_F(SessionTest, WatchesAndGoesOnFromThere) {
    FakeWall wall;
    RawClient other(wall.port());
    ASSERT_TRUE(other.greet());
    other.sendCamera(3, 0);
    ASSERT_TRUE(other.receiveA<protocol::FrameDone>());
    Session& session = start(wall.port());
    ASSERT_TRUE(eventually([&] { return session.state().told; }));
    EXPECT_FALSE(session.state().control);
    ASSERT_TRUE(session.state().frame);  // what the wall shows is known by then
    EXPECT_EQ(session.state().frame->camera.eye.x, 3);

    session.changeSetting("mode", "plp");  // waits
    other.sendCamera(4, 0);
    ASSERT_TRUE(eventually([&] { return session.state().frame->camera.eye.x == 4; }));
    other.close();
    ASSERT_TRUE(eventually([&] { return session.state().control; }));
    ASSERT_TRUE(eventually([&] { return valueOf(session.state(), "mode") == "plp"; }));
    session.setCamera(at(9));
    ASSERT_TRUE(eventually([&] { return wall.drawn().size() == 3; }));
    EXPECT_EQ(wall.drawn(), (std::vector<double>{3, 4, 9}));  // and not where it was itself
}

TEST_F(SessionTest, HandsOver) {
    FakeWall wall;
    Session& session = start(wall.port());
    ASSERT_TRUE(eventually([&] { return session.state().control; }));
    RawClient other(wall.port());
    EXPECT_FALSE(other.greet());
    ASSERT_TRUE(eventually([&] { return session.state().waiting == 1; }));
    session.wishControl(false);
    EXPECT_TRUE(other.receiveA<protocol::Control>()->granted);
    ASSERT_TRUE(eventually([&] { return !session.state().control; }));
    session.wishControl(true);
    other.send(protocol::Hello{protocol::kVersion, false});
    EXPECT_TRUE(eventually([&] { return session.state().control; }));
}

TEST_F(SessionTest, ARefusalIsKeptForPeople) {
    FakeWall wall;
    Session& session = start(wall.port());
    session.changeSetting("cache", "2G");
    ASSERT_TRUE(eventually([&] { return !session.state().refusal.empty(); }));
    EXPECT_NE(session.state().refusal.find("--cache"), std::string::npos);
    session.changeSetting("mode", "plp");  // not hindered by the refused one
    ASSERT_TRUE(eventually([&] { return valueOf(session.state(), "mode") == "plp"; }));
    EXPECT_EQ(session.state().refusal, "");
}

TEST_F(SessionTest, PreviewsAreWholePictures) {
    auto gateway = Gateway::listen("127.0.0.1", 0, testing::smallWall());
    ASSERT_TRUE(gateway.ok());
    Session& session = start((*gateway)->port());
    session.wishPreview(true);
    ASSERT_TRUE(eventually([&] { return (*gateway)->previewWish().wanted; }));
    const auto give = [&](std::uint64_t picture, std::uint32_t tile) {
        (*gateway)->tileImage({picture, tile, protocol::ImageKind::preview, {std::byte{1}}});
    };
    give(1, 0), give(2, 0), give(2, 1), give(3, 1);
    std::vector<protocol::TileImage> picture;
    ASSERT_TRUE(eventually([&] { return !(picture = session.previews()).empty(); }));
    ASSERT_EQ(picture.size(), 2u);
    for (std::uint32_t tile : {0u, 1u}) {
        EXPECT_EQ(picture[tile].tile, tile);
        EXPECT_EQ(picture[tile].sequence, 2u);
    }
    give(3, 0);
    ASSERT_TRUE(eventually([&] { return !(picture = session.previews()).empty(); }));
    EXPECT_EQ(picture[0].sequence, 3u);
    give(4, 7);  // of a tile that is not there
    ASSERT_TRUE(eventually([&] { return !session.state().trouble.empty(); }));
    EXPECT_NE(session.state().trouble.find("not asked for"), std::string::npos);
}

TEST_F(SessionTest, LyingServersAreLeft) {
    protocol::Welcome twins = testing::smallWall();
    twins.tiles[1].name = twins.tiles[0].name;
    FakeWall wall({}, twins);
    Session& session = start(wall.port());
    ASSERT_TRUE(eventually([&] { return !session.state().trouble.empty(); }));
    EXPECT_NE(session.state().trouble.find("two tiles"), std::string::npos);
    EXPECT_FALSE(session.state().connected);
}

}  // namespace
}  // namespace iwalk::client
