#include <gtest/gtest.h>

#include "tests/gateway/fake_wall.hpp"
#include "tests/gateway/raw_client.hpp"

// Settings that a client changes while the servers run.
namespace iwalk {
namespace {

using protocol::ChangeSettings;
using protocol::SettingsNow;
using testing::FakeWall;
using testing::RawClient;

std::string valueOf(const std::vector<protocol::NamedValue>& settings, const std::string& name) {
    for (const protocol::NamedValue& setting : settings)
        if (setting.name == name) return setting.value;
    return "none";
}

TEST(LiveSettings, AreThereFromTheNextCameraOnAndAllAreTold) {
    FakeWall wall;
    RawClient controller(wall.port()), watcher(wall.port());
    EXPECT_TRUE(controller.greet());
    EXPECT_FALSE(watcher.greet());
    controller.sendCamera(1, protocol::kLockstep);
    ASSERT_TRUE(controller.receiveA<protocol::FrameDone>());
    controller.send(ChangeSettings{{{"mode", "plp"}}});
    controller.sendCamera(2, protocol::kLockstep);
    ASSERT_TRUE(controller.receiveA<protocol::FrameDone>());
    EXPECT_EQ(wall.modes(), (std::vector<Mode>{Mode::cplp, Mode::plp}));

    const auto told = watcher.receiveA<SettingsNow>();
    ASSERT_TRUE(told);
    EXPECT_EQ(valueOf(told->settings, "mode"), "plp");
    EXPECT_EQ(valueOf(told->settings, "cache"), "1G");
    EXPECT_EQ(told->refusal, "");

    RawClient late(wall.port());
    ASSERT_TRUE(late.send(protocol::Hello{}));
    EXPECT_EQ(valueOf(late.receiveA<protocol::Welcome>()->settings, "mode"), "plp");
}

TEST(LiveSettings, WhatIsWrongChangesNothingAndIsExplained) {
    FakeWall wall;
    RawClient controller(wall.port()), watcher(wall.port());
    EXPECT_TRUE(controller.greet());
    EXPECT_FALSE(watcher.greet());
    const auto refusal = [](RawClient& client, const std::vector<protocol::NamedValue>& settings) {
        EXPECT_TRUE(client.send(ChangeSettings{settings}));
        const auto answer = client.receiveA<SettingsNow>();
        EXPECT_TRUE(answer);
        if (!answer) return std::string();
        EXPECT_EQ(valueOf(answer->settings, "mode"), "cplp");
        return answer->refusal;
    };
    EXPECT_NE(refusal(controller, {{"mode", "plp"}, {"mode", "best"}}).find("choose frustum"),
              std::string::npos);
    EXPECT_NE(refusal(controller, {{"mode", "plp"}, {"cache", "2G"}}).find("--cache 2G"), std::string::npos);
    EXPECT_NE(refusal(controller, {{"speed", "1"}}).find("no setting"), std::string::npos);
    EXPECT_NE(refusal(watcher, {{"mode", "plp"}}).find("another client"), std::string::npos);
    controller.sendCamera(1, protocol::kLockstep);
    ASSERT_TRUE(controller.receiveA<protocol::FrameDone>());
    EXPECT_EQ(wall.modes(), std::vector<Mode>{Mode::cplp});
}

TEST(LiveSettings, AClientThatReadsNoAnswersIsDropped) {
    FakeWall wall;
    RawClient deaf(wall.port());
    ASSERT_TRUE(deaf.greet());
    const std::vector<std::byte> one = protocol::encode(ChangeSettings{{{std::string(900, 'x'), "1"}}});
    std::vector<std::byte> many;
    for (int i = 0; i < 100; ++i) many.insert(many.end(), one.begin(), one.end());
    bool open = true;
    for (int i = 0; i < 2000 && open; ++i) open = deaf.sendBytes(many);
    EXPECT_TRUE(testing::eventually([&] { return !deaf.sendBytes(one); }));
}

TEST(LastFrame, IsToldToWhoComesLater) {
    FakeWall wall;
    RawClient controller(wall.port());
    ASSERT_TRUE(controller.greet());
    controller.sendCamera(7, protocol::kLockstep);
    ASSERT_TRUE(controller.receiveA<protocol::FrameDone>());
    RawClient late(wall.port());
    late.send(protocol::Hello{});
    const auto frame = late.receiveA<protocol::FrameDone>();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->sequence, 0u);
    EXPECT_EQ(frame->camera.eye.x, 7);
    EXPECT_FALSE(late.receiveA<protocol::Control>()->granted);  // after it
}

TEST(ControlLine, TheControllerIsToldHowManyWait) {
    FakeWall wall;
    RawClient controller(wall.port());
    ASSERT_TRUE(controller.greet());
    RawClient second(wall.port()), third(wall.port());
    EXPECT_FALSE(second.greet());
    EXPECT_EQ(controller.receiveA<protocol::Control>()->waiting, 1u);
    EXPECT_FALSE(third.greet());
    EXPECT_EQ(controller.receiveA<protocol::Control>()->waiting, 2u);
    second.close();
    EXPECT_EQ(controller.receiveA<protocol::Control>()->waiting, 1u);
    controller.send(protocol::Hello{protocol::kVersion, false});
    EXPECT_FALSE(controller.receiveA<protocol::Control>()->granted);
    const auto taken = third.receiveA<protocol::Control>();
    EXPECT_TRUE(taken->granted);
    EXPECT_EQ(taken->waiting, 0u);
}

}  // namespace
}  // namespace iwalk
