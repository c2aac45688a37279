#include "client/capture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "client/client.hpp"
#include "common/camera_path.hpp"
#include "tests/gateway/fake_wall.hpp"
#include "tests/gateway/raw_client.hpp"

namespace iwalk::client {
namespace {

namespace fs = std::filesystem;
using testing::FakeWall;

class ClientCapture : public ::testing::Test {
  protected:
    ClientCapture() { fs::create_directories(directory_); }
    ~ClientCapture() override { fs::remove_all(directory_); }

    // What the client says when it captures three frames: the error's message, or nothing.
    std::string capture(const FakeWall& wall, bool depth = false, int frames = 3) {
        std::vector<Camera> path(static_cast<std::size_t>(frames));
        for (std::size_t i = 0; i < path.size(); ++i)
            path[i].eye.x = path[i].target.x = static_cast<double>(i + 50);
        Options options;
        options.server = {"127.0.0.1", wall.port()};
        options.path = directory_ + "/path.json";
        options.captureDir = out_;
        options.captureDepth = depth;
        EXPECT_TRUE(saveCameraPath(options.path, path).ok());
        const auto done = run(options, nullptr);
        return done.ok() ? "" : done.error().message;
    }

    const std::string directory_ = ::testing::TempDir() + "iwalk-capture-" +
                                   ::testing::UnitTest::GetInstance()->current_test_info()->name();
    const std::string out_ = directory_ + "/deep/out";
};

std::vector<std::string> namesIn(const std::string& directory) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(directory)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

TEST_F(ClientCapture, TilesAndTheStitchedWall) {
    const FakeWall wall;
    ASSERT_EQ(capture(wall), "");
    EXPECT_EQ(namesIn(out_), (std::vector<std::string>{"frame-000000", "frame-000001", "frame-000002"}));
    EXPECT_EQ(namesIn(out_ + "/frame-000001"),
              (std::vector<std::string>{"left.png", "right.png", "wall.png"}));
    const auto picture = readPng(out_ + "/frame-000001/wall.png");
    ASSERT_TRUE(picture.ok()) << picture.error().message;
    ASSERT_EQ(picture->width, 36);
    ASSERT_EQ(picture->height, 8);
    const auto pixel = [&](int x, int y) {
        const std::uint8_t* p = picture->at(x, y);
        return std::vector<int>{p[0], p[1], p[2]};
    };
    for (const int y : {0, 7}) {
        EXPECT_EQ(pixel(0, y), (std::vector<int>{51, 0, 200}));
        EXPECT_EQ(pixel(15, y), (std::vector<int>{51, 0, 200}));
        EXPECT_EQ(pixel(16, y), (std::vector<int>{0, 0, 0}));  // the bezel
        EXPECT_EQ(pixel(19, y), (std::vector<int>{0, 0, 0}));
        EXPECT_EQ(pixel(20, y), (std::vector<int>{51, 1, 200}));
        EXPECT_EQ(pixel(35, y), (std::vector<int>{51, 1, 200}));
    }
}

TEST_F(ClientCapture, Depth) {
    const FakeWall wall;
    ASSERT_EQ(capture(wall, true), "");
    EXPECT_EQ(namesIn(out_ + "/frame-000002"),
              (std::vector<std::string>{"left.exr", "left.png", "right.exr", "right.png", "wall.png"}));
    const auto depth = readExr(out_ + "/frame-000002/right.exr");
    ASSERT_TRUE(depth.ok()) << depth.error().message;
    EXPECT_EQ(depth->width, 16);
    EXPECT_EQ(*depth->at(3, 3), 52.0f);
}

TEST_F(ClientCapture, ManyFrames) {
    const FakeWall wall;
    ASSERT_EQ(capture(wall, false, 60), "");
    EXPECT_EQ(namesIn(out_).size(), 60u);
    EXPECT_TRUE(fs::exists(out_ + "/frame-000059/wall.png"));
}

TEST_F(ClientCapture, FreeScreensHaveNoWallPicture) {
    protocol::Welcome free = testing::smallWall();
    free.wallWidth = free.wallHeight = 0;
    free.tiles[1].x = -3;
    const FakeWall wall({}, free);
    ASSERT_EQ(capture(wall), "");
    EXPECT_EQ(namesIn(out_ + "/frame-000000"), (std::vector<std::string>{"left.png", "right.png"}));
}

TEST_F(ClientCapture, WhatCameBeforeTheServerVanishedStays) {
    const FakeWall wall({.vanishAfter = 10});
    EXPECT_NE(capture(wall, false, 40), "");
    // The last frames may be lost in the server's end; every file there is is whole.
    for (const auto& entry : fs::recursive_directory_iterator(out_)) {
        if (!entry.is_regular_file()) continue;
        EXPECT_TRUE(readPng(entry.path()).ok()) << entry.path();
    }
    EXPECT_TRUE(fs::exists(out_ + "/frame-000000/wall.png"));
}

TEST_F(ClientCapture, PicturesOfTheWrongSize) {
    const FakeWall wall({.extraWidth = 1});
    const std::string message = capture(wall);
    EXPECT_NE(message.find("left.png of 17 x 8 px"), std::string::npos) << message;
}

TEST_F(ClientCapture, PicturesThatAreNone) {
    const FakeWall wall({.spoil = [](protocol::TileImage& image) { image.bytes.resize(20); }});
    EXPECT_NE(capture(wall).find(".png"), std::string::npos);
}

TEST_F(ClientCapture, PicturesThatWereNotAskedFor) {
    const FakeWall twice({.spoil = [](protocol::TileImage& image) { image.tile = 0; }});
    EXPECT_NE(capture(twice).find("not asked for"), std::string::npos);
    const FakeWall foreign({.spoil = [](protocol::TileImage& image) { image.tile = 2; }});
    EXPECT_NE(capture(foreign).find("not asked for"), std::string::npos);
    const FakeWall depth(
        {.spoil = [](protocol::TileImage& image) { image.kind = protocol::ImageKind::exr; }});
    EXPECT_NE(capture(depth).find("not asked for"), std::string::npos);
}

TEST_F(ClientCapture, HostileTileNames) {
    protocol::Welcome hostile = testing::smallWall();
    hostile.tiles[0].name = "../../escape";
    const FakeWall wall({}, hostile);
    EXPECT_NE(capture(wall).find("not a safe file name"), std::string::npos);
    EXPECT_FALSE(fs::exists(out_));
}

TEST_F(ClientCapture, ADirectoryThatCannotBe) {
    fs::create_directories(directory_);
    std::FILE* file = std::fopen((directory_ + "/deep").c_str(), "w");
    std::fclose(file);
    const FakeWall wall;
    const std::string message = capture(wall);
    EXPECT_NE(message.find(out_), std::string::npos) << message;
}

TEST_F(ClientCapture, APictureThatCannotBeWritten) {
    fs::create_directories(out_ + "/frame-000001/left.png/in-the-way");
    const FakeWall wall;
    const std::string message = capture(wall);
    EXPECT_NE(message.find("cannot write " + out_ + "/frame-000001/left.png"), std::string::npos) << message;
    EXPECT_TRUE(fs::exists(out_ + "/frame-000000/wall.png"));
}

}  // namespace
}  // namespace iwalk::client
