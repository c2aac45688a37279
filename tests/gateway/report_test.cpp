#include "client/report.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "client/client.hpp"
#include "common/camera_path.hpp"
#include "common/file.hpp"
#include "tests/gateway/fake_wall.hpp"
#include "tests/gateway/raw_client.hpp"

namespace iwalk::client {
namespace {

using json = nlohmann::json;

std::vector<std::string> keys(const json& object) {
    std::vector<std::string> names;
    for (const auto& [name, value] : object.items()) names.push_back(name);
    return names;  // sorted, as nlohmann's objects are
}

TEST(Report, HasTheKeysOfTheDesign) {
    protocol::FrameDone done{1, 1, 20, {{}, {}}};
    done.tiles[1].tile = 1;
    done.tiles[1].peakRssBytes = 99;
    const json report = json::parse(reportText(testing::smallWall(), {{0, done, 30}, {1, done, 30}}));
    EXPECT_EQ(keys(report),
              (std::vector<std::string>{"dataset", "frames", "settings", "summary", "version", "wall"}));
    EXPECT_EQ(report["version"], "9.8.7");
    EXPECT_EQ(report["dataset"], json({{"triangles", 123}, {"bytes", 4567}}));
    EXPECT_EQ(report["wall"], json({{"width_px", 36}, {"height_px", 8}, {"tiles", 2}}));
    EXPECT_EQ(report["settings"], json({{"cache", "1G"}, {"mode", "cplp"}}));
    ASSERT_EQ(report["frames"].size(), 2u);
    EXPECT_EQ(keys(report["frames"][1]),
              (std::vector<std::string>{"camera_to_swap_ms", "frame", "tiles", "time_ms"}));
    EXPECT_EQ(report["frames"][1]["frame"], 1);
    EXPECT_EQ(keys(report["frames"][1]["tiles"][1]), (std::vector<std::string>{"adapt_ms",
                                                                               "bad_pages",
                                                                               "barrier_wait_ms",
                                                                               "draw_ms",
                                                                               "fetch_wait_ms",
                                                                               "fetched_bytes",
                                                                               "guess_ms",
                                                                               "guess_triangles",
                                                                               "hidden_pages",
                                                                               "hidden_ranges",
                                                                               "host",
                                                                               "prefetched_bytes",
                                                                               "pyramid_ms",
                                                                               "ranges",
                                                                               "rank",
                                                                               "screen_error_px",
                                                                               "stalls",
                                                                               "test_ms",
                                                                               "tile",
                                                                               "triangles",
                                                                               "visibility_ms"}));
    EXPECT_EQ(report["frames"][1]["tiles"][1]["tile"], "right");
    EXPECT_EQ(report["summary"]["frame_ms"], json({{"median", 20.0}, {"p01", 20.0}, {"p99", 20.0}}));
    EXPECT_EQ(report["summary"]["camera_to_swap_ms"], json({{"median", 30.0}, {"p01", 30.0}, {"p99", 30.0}}));
    EXPECT_EQ(report["summary"]["tiles"][1], json({{"tile", "right"}, {"rank", 1}, {"peak_rss_bytes", 99}}));
}

TEST(Report, TheFirstFrameIsNotInTheSummary) {
    std::vector<PlayedFrame> frames{{0, {1, 1, 1e6, {}}}};
    EXPECT_FALSE(frameTimes(frames).has_value());
    EXPECT_TRUE(
        json::parse(reportText(testing::smallWall(), frames))["summary"]["frame_ms"]["median"].is_null());
    for (std::uint64_t i = 1; i <= 101; ++i)
        frames.push_back({i, {i + 1, i + 1, static_cast<double>(i), {}}});
    EXPECT_EQ(frameTimes(frames)->median, 51);
    EXPECT_EQ(frameTimes(frames)->p01, 2);
    EXPECT_EQ(frameTimes(frames)->p99, 100);
}

TEST(Report, IsWrittenByTheClient) {
    const std::string directory = ::testing::TempDir() + "iwalk-report";
    std::filesystem::create_directories(directory);
    const testing::FakeWall wall;
    Options options;
    options.server = {"127.0.0.1", wall.port()};
    options.path = directory + "/path.json";
    options.report = directory + "/report.json";
    ASSERT_TRUE(saveCameraPath(options.path, std::vector<Camera>(4)).ok());
    const auto done = run(options, nullptr);
    ASSERT_TRUE(done.ok()) << done.error().message;
    const json report = json::parse(readWholeFile(options.report, 1u << 20).value());
    ASSERT_EQ(report["frames"].size(), 4u);
    EXPECT_EQ(report["frames"][3]["frame"], 3);
    EXPECT_EQ(report["frames"][3]["tiles"][0]["triangles"], 1000);
    EXPECT_EQ(report["summary"]["tiles"][0]["peak_rss_bytes"], 900);  // the second frame's was the largest
    std::filesystem::remove_all(directory);
}

}  // namespace
}  // namespace iwalk::client
