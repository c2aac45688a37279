// Builds that cannot succeed: the error says why in one line, and nothing is left behind.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "common/file.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/soup.hpp"

namespace iwalk {
namespace {

class FailureTest : public testing::Test {
  protected:
    std::string output() const { return directory_.path("out"); }

    // The build's error, of one line; it must name `named`.
    void expectError(const Result<Manifest>& result, const std::string& named) {
        ASSERT_FALSE(result.ok());
        EXPECT_NE(result.error().message.find(named), std::string::npos) << result.error().message;
        EXPECT_EQ(result.error().message.find('\n'), std::string::npos) << result.error().message;
    }
    Result<Manifest> buildFile(const std::string& input) {
        NoProgress progress;
        BuildOptions options;
        options.inputs = {input};
        options.output = output();
        return buildDataset(options, progress);
    }

    TempDirectory directory_;
    FakeInput soup_ = makeSoup(5000, 0.01, 0.1, 1);
};

TEST_F(FailureTest, MissingInput) {
    expectError(buildFile(directory_.path("none.ply")), "none.ply");
    EXPECT_EQ(directory_.list(), std::vector<std::string>{});
}

TEST_F(FailureTest, TruncatedInput) {
    writePly(directory_.path("in.ply"), soup_.triangles);
    ASSERT_TRUE(buildFile(directory_.path("in.ply")).ok());
    std::filesystem::remove_all(output());
    std::filesystem::resize_file(directory_.path("in.ply"), 100'000);
    expectError(buildFile(directory_.path("in.ply")), "in.ply");
    EXPECT_EQ(directory_.list(), std::vector<std::string>{"in.ply"});
}

TEST_F(FailureTest, InputThatBreaksOffLate) {
    soup_.failAfter = 3000;
    expectError(buildFrom(soup_, output()), "fake.ply: byte 7: broken");
    EXPECT_EQ(directory_.list(), std::vector<std::string>{});
}

TEST_F(FailureTest, OldDatasetStays) {
    ASSERT_TRUE(buildFrom(soup_, output()).ok());
    const auto before = readTriangles(output());
    const auto files = directory_.list();
    soup_.failAfter = 3000;
    expectError(buildFrom(soup_, output()), "broken");
    EXPECT_EQ(directory_.list(), files);
    EXPECT_TRUE(readTriangles(output()) == before);
}

TEST_F(FailureTest, NewDatasetReplacesTheOld) {
    ASSERT_TRUE(buildFrom(soup_, output()).ok());
    const auto manifest = buildFrom(makeSoup(100, 0.1, 0.2, 2), output());
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    EXPECT_EQ(manifest->generation, 2u);
    EXPECT_EQ(readTriangles(output()).size(), 100u);
    EXPECT_EQ(directory_.list(), (std::vector<std::string>{"out", "out/dataset.json", "out/hierarchy-2.bin",
                                                           "out/pages-2.bin"}));
}

TEST_F(FailureTest, OutputThatIsNoDataset) {
    std::filesystem::create_directory(output());
    directory_.write("out/thesis.txt", "years of work");
    expectError(buildFrom(soup_, output()), "not a dataset");
    EXPECT_EQ(directory_.list(), (std::vector<std::string>{"out", "out/thesis.txt"}));
    directory_.write("file", "x");
    expectError(buildFrom(soup_, directory_.path("file")), "not a directory");
    expectError(buildFrom(soup_, directory_.path("no/such/parent")), "cannot make the directory");
}

TEST_F(FailureTest, EmptyOutputDirectoryIsUsedAndKept) {
    std::filesystem::create_directory(output());
    soup_.failAfter = 0;
    expectError(buildFrom(soup_, output()), "broken");
    EXPECT_EQ(directory_.list(), std::vector<std::string>{"out"});
}

TEST_F(FailureTest, LeftoversOfAKilledBuildGo) {
    std::filesystem::create_directories(output() + "/.iwalk-build");
    directory_.write("out/.iwalk-build/triangles", "x");
    directory_.write("out/.iwalk-lock", "");
    directory_.write("out/pages-1.bin", "x");
    const auto manifest = buildFrom(soup_, output());
    ASSERT_TRUE(manifest.ok()) << manifest.error().message;
    EXPECT_EQ(directory_.list(), (std::vector<std::string>{"out", "out/dataset.json", "out/hierarchy-2.bin",
                                                           "out/pages-2.bin"}));
}

TEST_F(FailureTest, TwoBuildsDoNotMeet) {
    std::filesystem::create_directory(output());
    const int lock = ::open((output() + "/.iwalk-lock").c_str(), O_RDWR | O_CREAT, 0666);
    ASSERT_EQ(::flock(lock, LOCK_EX), 0);
    expectError(buildFrom(soup_, output()), "another build is at work");
    EXPECT_EQ(directory_.list(), (std::vector<std::string>{"out", "out/.iwalk-lock"}));
    ::close(lock);
    EXPECT_TRUE(buildFrom(soup_, output()).ok());
}

// A limit on file sizes stands in for a full disk; the first file to grow is that of the triangles.
TEST_F(FailureTest, FullDisk) {
    ASSERT_TRUE(buildFrom(soup_, output()).ok());
    const auto before = directory_.list();
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
    for (const rlim_t bytes : {0, 1000, 20'000, 100'000}) {
        const rlimit small{bytes, limit.rlim_max};
        ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
        const auto result = buildFrom(soup_, output());
        setrlimit(RLIMIT_FSIZE, &limit);
        expectError(result, "free some space");
        expectError(result, output());
        EXPECT_EQ(directory_.list(), before) << bytes;
    }
}

TEST_F(FailureTest, NothingToBuild) {
    FakeInput empty;
    expectError(buildFrom(empty, output()), "nothing to build");
    empty.triangles = {makeTriangle({1, 1, 1}, {1, 1, 1}, {1, 1, 1})};
    expectError(buildFrom(empty, output()), "nothing to build");
    EXPECT_EQ(directory_.list(), std::vector<std::string>{});
}

TEST_F(FailureTest, TrianglesOutOfReachNameTheStep) {
    FakeInput far = soup_;
    far.triangles.push_back(makeTriangle({1e12, 0, 0}, {1e12, 1, 0}, {1e12, 0, 1}));
    expectError(buildFrom(far, output()), "--step");
    expectError(buildFrom(far, output()), "triangle 5000");
    // Of what is only long, the part within reach stays.
    far.triangles.back() = makeTriangle({1e300, 0, 0}, {-1e300, 1, 0}, {0, 0, 1});
    const Result<Manifest> built = buildFrom(far, output());
    ASSERT_TRUE(built.ok()) << built.error().message;
    EXPECT_EQ(built->provenance.at(0).cut, 1u);
}

TEST_F(FailureTest, OptionsOutOfRange) {
    expectError(buildFrom(soup_, output(), {.memoryBytes = 63u << 20}), "--memory");
    expectError(buildFrom(soup_, output(), {.leafTriangles = 15}), "--leaf-triangles");
    expectError(buildFrom(soup_, output(), {.leafTriangles = 65537}), "--leaf-triangles");
    expectError(buildFrom(soup_, output(), {.stepExponent = 2000}), "--step");
    EXPECT_EQ(directory_.list(), std::vector<std::string>{});
}

}  // namespace
}  // namespace iwalk
