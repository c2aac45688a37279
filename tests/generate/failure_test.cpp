// What cannot be made: the error says why in one line, nothing is left behind, and what was there stays.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "common/file.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/generate/generated.hpp"

namespace iwalk {
namespace {

class GenerateFailureTest : public testing::Test {
  protected:
    // Expects an error of one line that has `part`.
    void expectError(const std::string& scene, std::uint64_t triangles, const std::string& name,
                     const std::string& part) {
        QuietProgress progress;
        GenerateOptions options;
        options.scene = scene;
        options.triangles = triangles;
        options.output = directory_.path(name);
        const auto made = generateScene(options, progress);
        ASSERT_FALSE(made.ok());
        EXPECT_NE(made.error().message.find(part), std::string::npos) << made.error().message;
        EXPECT_EQ(made.error().message.find('\n'), std::string::npos) << made.error().message;
    }
    TempDirectory directory_;
};

TEST_F(GenerateFailureTest, CountOutOfRange) {
    expectError("plant", 999, "a.ply", "999 triangles cannot be made: 1000 to 1000000000 can");
    expectError("plant", 1'000'000'001, "a.ply", "1000000001");
    EXPECT_EQ(directory_.list(), std::vector<std::string>{});
}

TEST_F(GenerateFailureTest, UnknownScene) {
    expectError("cube", 1'000, "a.ply", "there is no scene 'cube'");
    EXPECT_EQ(directory_.list(), std::vector<std::string>{});
}

TEST_F(GenerateFailureTest, MissingDirectory) {
    expectError("sphere", 1'000, "none/a.ply", "none: make it first");
}

TEST_F(GenerateFailureTest, OutputIsADirectory) {
    std::filesystem::create_directory(directory_.path("a.ply"));
    expectError("sphere", 1'000, "a.ply", "a.ply: is there and no file");
    EXPECT_EQ(directory_.list(), std::vector<std::string>{"a.ply"});
}

TEST_F(GenerateFailureTest, FullDisk) {
    directory_.write("a.ply", "precious");
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    for (const char* scene : {"sphere", "plant", "isosurface"}) {
        for (const rlim_t bytes : {100, 200'000, 1'500'000}) {  // in the header, the vertices, the triangles
            rlimit small = before;
            small.rlim_cur = bytes;
            ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
            expectError(scene, 100'000, "a.ply", "free some space");
            ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
        }
    }
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(directory_.list(), std::vector<std::string>{"a.ply"});
    EXPECT_EQ(readWholeFile(directory_.path("a.ply"), 100).value(), "precious");
}

}  // namespace
}  // namespace iwalk
