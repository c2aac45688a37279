#include "common/file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "tests/common/temp_directory.hpp"

namespace iwalk {
namespace {

TEST(FileTest, WritesInPiecesAndReadsAnyPlace) {
    const TempDirectory directory;
    std::vector<std::uint32_t> values(200'000);
    std::iota(values.begin(), values.end(), 0u);
    auto output = OutputFile::create(directory.path("a"));
    ASSERT_TRUE(output.ok());
    const std::span<const std::uint32_t> all(values);
    for (std::size_t at = 0; at < values.size();) {  // pieces smaller and larger than the buffer
        const std::size_t count = std::min(values.size() - at, 1 + at);
        ASSERT_TRUE(output->write(bytesOf(all.subspan(at, count))).ok());
        at += count;
    }
    EXPECT_EQ(output->size(), values.size() * 4);
    ASSERT_TRUE(output->sync().ok());

    const auto file = openForReading(directory.path("a"));
    ASSERT_TRUE(file.ok());
    EXPECT_EQ((*file)->size(), values.size() * 4);
    for (const std::uint32_t at : {0u, 77'777u, 199'999u}) {
        std::uint32_t value = 0;
        ASSERT_TRUE((*file)->readAt(at * 4, std::as_writable_bytes(std::span(&value, 1))).ok());
        EXPECT_EQ(value, at);
    }
}

TEST(FileTest, ReadingBeyondTheEndNamesFileAndPlace) {
    const TempDirectory directory;
    directory.write("short", "abc");
    const auto file = openForReading(directory.path("short"));
    ASSERT_TRUE(file.ok());
    std::array<std::byte, 4> out{};
    const auto result = (*file)->readAt(1, out);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().message, directory.path("short") + ": ends at byte 3, 2 bytes short");
}

TEST(FileTest, OpeningSaysWhy) {
    const TempDirectory directory;
    EXPECT_NE(openForReading(directory.path("none")).error().message.find("No such file"), std::string::npos);
    EXPECT_NE(openForReading(directory.path("")).error().message.find("not a regular file"),
              std::string::npos);
    EXPECT_NE(OutputFile::create(directory.path("no/file")).error().message.find("no/file"),
              std::string::npos);
}

TEST(FileTest, WholeFileHasALimit) {
    const TempDirectory directory;
    directory.write("text", std::string(100'000, 'x'));
    EXPECT_EQ(readWholeFile(directory.path("text"), 100'000).value().size(), 100'000u);
    EXPECT_FALSE(readWholeFile(directory.path("text"), 99'999).ok());
}

TEST(FileTest, ReplacingLeavesNothingBeside) {
    const TempDirectory directory;
    ASSERT_TRUE(replaceFile(directory.path("a"), "one").ok());
    ASSERT_TRUE(replaceFile(directory.path("a"), "two").ok());
    EXPECT_EQ(readWholeFile(directory.path("a"), 10).value(), "two");
    EXPECT_EQ(directory.list(), std::vector<std::string>{"a"});
    EXPECT_FALSE(replaceFile(directory.path("missing/a"), "x").ok());
}

TEST(FileTest, OverwritesWhatItWrote) {
    const TempDirectory directory;
    auto output = OutputFile::create(directory.path("a"));
    ASSERT_TRUE(output.ok());
    ASSERT_TRUE(output->write(std::as_bytes(std::span("0 vertices", 10))).ok());
    ASSERT_TRUE(output->overwrite(0, std::as_bytes(std::span("7", 1))).ok());
    ASSERT_TRUE(output->write(std::as_bytes(std::span(" here", 5))).ok());
    EXPECT_EQ(output->size(), 15u);
    ASSERT_TRUE(output->sync().ok());
    EXPECT_EQ(readWholeFile(directory.path("a"), 100).value(), "7 vertices here");
}

// A limit on file sizes stands in for a full disk.
TEST(FileTest, AFullDiskIsAnErrorThatNamesTheFile) {
    const TempDirectory directory;
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    rlimit small = before;
    small.rlim_cur = 100'000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    auto output = OutputFile::create(directory.path("big"));
    const std::vector<std::byte> bytes(300'000);
    const auto written = output->write(bytes);
    const auto replaced = replaceFile(directory.path("manifest"), std::string(200'000, 'x'));
    setrlimit(RLIMIT_FSIZE, &before);

    ASSERT_FALSE(written.ok());
    EXPECT_NE(written.error().message.find(directory.path("big") + ": cannot write at byte 100000"),
              std::string::npos)
        << written.error().message;
    EXPECT_FALSE(replaced.ok());
    EXPECT_EQ(directory.list(), std::vector<std::string>{"big"});
}

}  // namespace
}  // namespace iwalk
