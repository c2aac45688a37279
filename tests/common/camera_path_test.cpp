#include "common/camera_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace iwalk {
namespace {

class CameraPath : public testing::Test {
  protected:
    CameraPath() {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        file_ = testing::TempDir() + "iwalk-path-" + info->name() + ".json";
    }
    ~CameraPath() override { std::filesystem::remove(file_); }

    std::string refusal(const std::string& text) {
        std::ofstream(file_) << text;
        const auto loaded = loadCameraPath(file_);
        return loaded.ok() ? "" : loaded.error().message;
    }

    std::string file_;
};

TEST_F(CameraPath, WhatIsSavedIsLoaded) {
    const std::vector<Camera> frames{{{0.1, 1e300, -3}, {4, 5, 6}, {0, 1, 1}, 47.5},
                                     {{1, 2, 3}, {3, 2, 1}, {0, 1, 0}, 47.5}};
    ASSERT_TRUE(saveCameraPath(file_, frames).ok());
    const auto loaded = loadCameraPath(file_);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    EXPECT_EQ(*loaded, frames);
}

TEST_F(CameraPath, TheFormatOfTheDocuments) {
    std::ofstream(file_)
        << R"({"fov_y_deg": 60, "frames": [{"eye": [1,2,3], "target": [0,0,0], "up": [0,1,0]}]})";
    const auto loaded = loadCameraPath(file_);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    ASSERT_EQ(loaded->size(), 1u);
    EXPECT_EQ(loaded->front(), (Camera{{1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 60}));
}

TEST_F(CameraPath, ErrorsNameFileAndFrame) {
    const std::string good = R"({"eye": [1,2,3], "target": [0,0,0], "up": [0,1,0]})";
    const auto path = [&](const std::string& second) {
        return R"({"fov_y_deg": 60, "frames": [)" + good + "," + second + "]}";
    };
    for (const char* bad :
         {"{}", "[]", "3", R"({"eye": [1,2], "target": [0,0,0], "up": [0,1,0]})",
          R"({"eye": [1,2,"3"], "target": [0,0,0], "up": [0,1,0]})",
          R"({"eye": [1,2,3], "target": [1,2,3], "up": [0,1,0]})", R"({"eye": [1,2,3], "target": [0,0,0]})",
          R"({"eye": [0,1,0], "target": [0,0,0], "up": [0,1,0]})"}) {
        const std::string message = refusal(path(bad));
        EXPECT_NE(message.find(file_), std::string::npos) << message;
        EXPECT_NE(message.find("frame 1:"), std::string::npos) << message;
    }
}

TEST_F(CameraPath, BrokenFiles) {
    for (const char* bad :
         {"", "{", "[]", "null", "\xff", R"({"frames": []})", R"({"fov_y_deg": 60})",
          R"({"fov_y_deg": 60, "frames": []})", R"({"fov_y_deg": "60", "frames": []})",
          R"({"fov_y_deg": 180, "frames": [{"eye": [1,2,3], "target": [0,0,0], "up": [0,1,0]}]})",
          R"({"fov_y_deg": 60, "frames": [{"eye": [1e999,2,3], "target": [0,0,0], "up": [0,1,0]}]})"}) {
        const std::string message = refusal(bad);
        EXPECT_NE(message.find(file_), std::string::npos) << bad << ": " << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    EXPECT_FALSE(loadCameraPath("/nonexistent/path.json").ok());
}

TEST_F(CameraPath, SaveRefusesWhatLoadWould) {
    EXPECT_FALSE(saveCameraPath(file_, {}).ok());
    Camera other;
    other.fovY = 61;
    EXPECT_FALSE(saveCameraPath(file_, {Camera{}, other}).ok());
    other.fovY = 0;
    EXPECT_FALSE(saveCameraPath(file_, {other}).ok());
    EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST(CheckCamera, Refusals) {
    EXPECT_TRUE(checkCamera(Camera{}).ok());
    const double inf = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(checkCamera({{inf, 0, 0}, {0, 0, 0}, {0, 1, 0}, 60}).ok());
    EXPECT_FALSE(checkCamera({{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, std::nan("")}).ok());
    EXPECT_FALSE(checkCamera({{0, 0, 0}, {0, 0, -1}, {0, 0, 0}, 60}).ok());
    EXPECT_FALSE(checkCamera({{0, 0, 0}, {0, 0, -1}, {0, 0, 5}, 60}).ok());
    EXPECT_FALSE(checkCamera({{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1}).ok());
    EXPECT_FALSE(checkCamera({{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 179}).ok());
    EXPECT_FALSE(checkCamera({{-1.7e308, 0, 0}, {1.7e308, 0, 0}, {0, 1, 0}, 60}).ok());
}

TEST(CheckCamera, ExtremeScalesAreFine) {
    EXPECT_TRUE(checkCamera({{0, 0, 0}, {0, 0, -1e-200}, {0, 1e-200, 0}, 60}).ok());
    EXPECT_TRUE(checkCamera({{0, 0, 0}, {0, 0, -1e300}, {0, 1e300, 0}, 60}).ok());
}

}  // namespace
}  // namespace iwalk
