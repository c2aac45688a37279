#include "server/frame/last_state.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "server/frame/same_dataset.hpp"

namespace iwalk {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

LastState::Clock::time_point at(int ms) {
    return LastState::Clock::time_point(std::chrono::hours(1)) + milliseconds(ms);
}

class LastStateTest : public ::testing::Test {
  protected:
    LastStateTest() {
        start_.mode = Mode::plp;
        start_.show = Show::priority;
        fs::remove(file_);
    }
    ~LastStateTest() override { fs::remove_all(file_); }

    LastState::Known known() const { return LastState(file_, start_).load(); }
    // Whether a file with this text is taken; else the wall must begin as if there were none.
    bool takes(const std::string& text) const {
        std::ofstream(file_) << text;
        const LastState::Known read = known();
        const bool nothing = !read.camera && read.settings == start_;
        return !nothing;
    }

    const std::string file_ = ::testing::TempDir() + "iwalk-last-state-" +
                              ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".json";
    const Camera camera_{{1.25e9, -2, 3}, {4, 5, 6}, {0, 0, 1}, 33.5};
    Settings start_;
};

TEST_F(LastStateTest, CameraAndChangedSettingsComeBack) {
    LastState last(file_, start_);
    EXPECT_FALSE(last.load().camera);
    Settings changed = start_;
    changed.mode = Mode::cplp;
    changed.show = Show::none;
    changed.background = 0x102030;
    changed.maxFps = 30;
    last.shows(camera_, at(0));
    last.changes(changed, at(0));
    last.keep(at(199));
    EXPECT_FALSE(fs::exists(file_));
    last.keep(at(200));
    EXPECT_EQ(known().camera, camera_);
    EXPECT_EQ(known().settings, changed);

    // What was not changed is that of the command line, also another one's.
    start_.cacheBytes = 5u << 20;
    start_.plpBudget = 12345;
    EXPECT_EQ(known().settings.cacheBytes, 5u << 20);
    EXPECT_EQ(known().settings.plpBudget, 12345u);
    EXPECT_EQ(known().settings.background, 0x102030u);
}

TEST_F(LastStateTest, WhatWasKeptIsKeptOn) {
    LastState first(file_, start_);
    Settings changed = start_;
    changed.near = 2;
    first.changes(changed, at(0));
    first.keep(at(500));
    LastState second(file_, start_);
    EXPECT_EQ(second.load().settings.near, 2);
    second.shows(camera_, at(1000));
    second.keep(at(1500));
    EXPECT_EQ(known().settings.near, 2);
    EXPECT_EQ(known().camera, camera_);
}

TEST_F(LastStateTest, AMovingCameraIsWrittenNowAndThen) {
    LastState last(file_, start_);
    Camera camera = camera_;
    int written = -1;
    for (int ms = 0; ms < 3000 && written < 0; ms += 10) {
        camera.eye.x = ms;
        last.shows(camera, at(ms));
        last.keep(at(ms));
        if (fs::exists(file_)) written = ms;
    }
    EXPECT_EQ(written, 2000);
    ASSERT_TRUE(known().camera);
    EXPECT_EQ(known().camera->eye.x, 2000);
}

TEST_F(LastStateTest, ABeatMakesTheFileOrTouchesIt) {
    LastState last(file_, start_);
    ASSERT_TRUE(last.beatDue(at(0)));
    last.beat(at(0));
    ASSERT_TRUE(fs::exists(file_));
    EXPECT_FALSE(known().camera);
    EXPECT_FALSE(last.beatDue(at(999)));
    EXPECT_TRUE(last.beatDue(at(1000)));
    const fs::file_time_type old = fs::file_time_type::clock::now() - std::chrono::hours(1);
    fs::last_write_time(file_, old);
    last.beat(at(1000));
    EXPECT_GT(fs::last_write_time(file_), old + std::chrono::minutes(1));
    EXPECT_FALSE(LastState("", start_).beatDue(at(0)));
}

TEST_F(LastStateTest, WhatIsNotOursIsNotTaken) {
    const std::string camera =
        R"("camera": {"eye": [1,2,3], "target": [4,5,6], "up": [0,0,1], "fov_y_deg": )";
    EXPECT_TRUE(takes("{" + camera + R"(60}, "settings": {"near": "3"}})"));
    EXPECT_TRUE(takes(R"({"settings": {"near": "3"}})"));
    for (const std::string& bad :
         {std::string(), std::string("{"), std::string("[]"), std::string("{}"), std::string(1u << 20, ' '),
          "{" + camera + R"(60}})", "{" + camera + R"(600}, "settings": {"near": "3"}})",
          std::string(R"({"camera": {"eye": [1,2]}, "settings": {"near": "3"}})"),
          std::string(R"({"settings": {"near": 3}})"), std::string(R"({"settings": {"near": "-3"}})"),
          std::string(R"({"settings": {"cache": "1T"}})"), std::string(R"({"settings": {"speed": "1"}})"),
          std::string(R"({"settings": {"near": "3", "mode": "cplp"}})")})  // priority goes with plp only
        EXPECT_FALSE(takes(bad)) << bad.substr(0, 100);
    fs::remove(file_);
    fs::create_directory(file_);
    EXPECT_FALSE(known().camera);
}

TEST(SameDataset, NamesTheFirstTwoThatDiffer) {
    const std::vector<std::string> hosts{"a", "b", "c"};
    const std::string one = datasetNote(1, "/data/x"), two = datasetNote(2, "/data/y");
    EXPECT_TRUE(sameDataset({one, one, datasetNote(1, "/elsewhere")}, hosts).ok());
    const Result<void> different = sameDataset({one, one, two}, hosts);
    ASSERT_FALSE(different.ok());
    EXPECT_NE(different.error().message.find("/data/y on c (rank 2)"), std::string::npos);
    EXPECT_NE(different.error().message.find("/data/x on a (rank 0)"), std::string::npos);
}

}  // namespace
}  // namespace iwalk
