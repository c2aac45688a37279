#include "client/fly/flight.hpp"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "tests/common/temp_directory.hpp"
#include "tests/gateway/fake_wall.hpp"
#include "tests/gateway/raw_client.hpp"

namespace iwalk::client {
namespace {

using testing::eventually;
using testing::FakeWall;
using testing::RawClient;

// A person at a wall without a window.
class FlightTest : public ::testing::Test {
  protected:
    FlightTest() {
        options_.views = directory_.path("views.json");
        options_.up = {0, 1, 0};
    }
    Flight& start(const FakeWall& wall) {
        options_.server = {"127.0.0.1", wall.port()};
        session_.emplace(options_.server, protocol::Hello{}, [] {});
        return flight_.emplace(options_, *session_, SavedViews::open(options_.views).value());
    }
    // Steps of a hundredth of a second until `condition` holds.
    template <class Condition>
    bool until(Condition condition, const Motion& wanted = {}) {
        return eventually([&] {
            flight_->step(time_ += 0.01, wanted);
            return condition();
        });
    }
    glm::dvec3 shown() { return flight_->wall().frame ? flight_->wall().frame->camera.eye : glm::dvec3(0); }
    bool arrived() {
        return flight_->wall().frame && flight_->wall().frame->camera == flight_->navigator()->camera();
    }

    TempDirectory directory_;
    Options options_;
    std::optional<Session> session_;
    std::optional<Flight> flight_;
    double time_ = 100;
};

TEST_F(FlightTest, BeginsAtHomeAndFlies) {
    FakeWall wall;
    Flight& flight = start(wall);
    ASSERT_TRUE(until([&] { return flight.steers() && arrived(); }));
    const glm::dvec3 home = flight.navigator()->homeView().eye;
    EXPECT_EQ(shown(), home);
    ASSERT_TRUE(until([&] { return glm::distance(shown(), home) > 0.2; }, {.forward = 1}));
    EXPECT_LT(glm::length(shown()), glm::length(home));  // towards the middle
}

TEST_F(FlightTest, AWallThatShowsSomethingIsNotMoved) {
    FakeWall wall;
    RawClient before(wall.port());
    ASSERT_TRUE(before.greet());
    before.sendCamera(7, 0);
    ASSERT_TRUE(before.receiveA<protocol::FrameDone>());
    before.close();
    Flight& flight = start(wall);
    ASSERT_TRUE(until([&] { return flight.steers(); }));
    for (int i = 0; i < 50; ++i) flight.step(time_ += 0.01, {});
    EXPECT_EQ(flight.navigator()->camera().eye.x, 7);
    EXPECT_EQ(wall.drawn(), std::vector<double>{7});
}

TEST_F(FlightTest, SavedViewsComeBack) {
    FakeWall wall;
    Flight& flight = start(wall);
    ASSERT_TRUE(until([&] { return flight.steers(); }));
    flight.recallView(4);
    EXPECT_NE(flight.note().find("no view 5 yet"), std::string::npos);
    flight.turn(0.3, 0.1);
    const Camera kept = flight.navigator()->camera();
    flight.saveView(4);
    EXPECT_NE(flight.note().find("views.json"), std::string::npos);
    flight.goHome();
    ASSERT_TRUE(until([&] { return arrived(); }));
    flight.recallView(4);
    ASSERT_TRUE(until([&] { return arrived(); }));
    EXPECT_EQ(shown(), kept.eye);
    EXPECT_EQ(flight.wall().frame->camera, kept);
    EXPECT_EQ(loadCameraPath(options_.views)->at(4), kept);
}

TEST_F(FlightTest, RecordsAndReplays) {
    FakeWall wall;
    options_.record = directory_.path("flight.json");
    Flight& flight = start(wall);
    EXPECT_TRUE(flight.recording());
    ASSERT_TRUE(until([&] { return flight.recorded() >= 20; }, {.right = 1}));
    flight.toggleRecording();
    EXPECT_FALSE(flight.recording());
    const auto path = loadCameraPath(options_.record);
    ASSERT_TRUE(path.ok()) << path.error().message;
    EXPECT_EQ(path->size(), flight.recorded());

    flight.goHome();
    flight.toggleReplay();
    EXPECT_TRUE(flight.replaying());
    ASSERT_TRUE(until([&] { return !flight.replaying(); }));
    ASSERT_TRUE(until([&] { return arrived(); }));
    EXPECT_EQ(flight.wall().frame->camera, path->back());

    flight.toggleReplay();
    ASSERT_TRUE(until([&] { return !flight.replaying(); }, {.up = 1}));  // a key ends it
}

TEST_F(FlightTest, SettingsByKey) {
    FakeWall wall;
    Flight& flight = start(wall);
    ASSERT_TRUE(until([&] { return flight.steers(); }));
    EXPECT_EQ(flight.value("mode"), "cplp");
    flight.changeToNext("mode");
    ASSERT_TRUE(until([&] { return flight.value("mode") == "frustum"; }));
    flight.changeToNext("mode");
    ASSERT_TRUE(until([&] { return flight.value("mode") == "plp"; }));
    EXPECT_EQ(flight.note(), "mode = plp");
}

TEST_F(FlightTest, WhoWatchesFollowsAndTakesOverFromThere) {
    FakeWall wall;
    RawClient other(wall.port());
    ASSERT_TRUE(other.greet());
    Flight& flight = start(wall);
    other.sendCamera(3, 0);
    ASSERT_TRUE(
        until([&] { return flight.navigator() && flight.navigator()->camera().eye.x == 3; }, {.right = 1}));
    EXPECT_FALSE(flight.steers());
    flight.change("mode", "plp");
    EXPECT_NE(flight.note().find("does not steer"), std::string::npos);
    flight.goHome();
    EXPECT_EQ(flight.navigator()->camera().eye.x, 3);
    other.close();
    ASSERT_TRUE(until([&] { return flight.steers(); }));
    ASSERT_TRUE(until([&] { return shown().x > 3.01; }, {.right = 1}));
    for (const double x : wall.drawn()) EXPECT_GE(x, 3);
}

TEST_F(FlightTest, WhateverServersSayCamerasAreValid) {
    auto gateway = Gateway::listen("127.0.0.1", 0, testing::smallWall());
    ASSERT_TRUE(gateway.ok());
    options_.server = {"127.0.0.1", (*gateway)->port()};
    session_.emplace(options_.server, protocol::Hello{}, [] {});
    flight_.emplace(options_, *session_, SavedViews::open(options_.views).value());
    ASSERT_TRUE(until([&] { return flight_->steers(); }));
    protocol::FrameDone frame{0, 1, 1, {}, {{1e300, 0, 0}, {-1e308, 1e308, 0}, {0, 0, 1}, 60}};
    frame.tiles.push_back({.nearDepth = 1e308, .midDepth = 1e308});
    (*gateway)->frameDone(frame);
    ASSERT_TRUE(until([&] { return flight_->wall().frame != nullptr; }));
    flight_->beginOrbit();
    flight_->orbit(0.1, 0.1);
    for (int i = 0; i < 20; ++i) flight_->step(time_ += 0.01, {.right = 1, .forward = 1, .fast = true});
    std::optional<protocol::CameraRequest> request;  // encoding an impossible one would have ended this
    ASSERT_TRUE(eventually([&] { return (request = (*gateway)->nextRequest()).has_value(); }));
    EXPECT_TRUE(checkCamera(request->camera).ok());
}

TEST_F(FlightTest, HandsOver) {
    FakeWall wall;
    Flight& flight = start(wall);
    ASSERT_TRUE(until([&] { return flight.steers(); }));
    RawClient other(wall.port());
    EXPECT_FALSE(other.greet());
    ASSERT_TRUE(until([&] { return flight.wall().waiting == 1; }));
    flight.toggleControl();
    EXPECT_TRUE(other.receiveA<protocol::Control>()->granted);
    ASSERT_TRUE(until([&] { return !flight.steers(); }));
    flight.toggleControl();
    other.close();
    EXPECT_TRUE(until([&] { return flight.steers(); }));
}

TEST(Choices, OfForms) {
    EXPECT_EQ(choicesOf("frustum|plp|cplp"), (std::vector<std::string>{"frustum", "plp", "cplp"}));
    EXPECT_TRUE(choicesOf("L|full").empty());
    EXPECT_TRUE(choicesOf("BYTES").empty());
    EXPECT_TRUE(choicesOf("").empty());
}

}  // namespace
}  // namespace iwalk::client
