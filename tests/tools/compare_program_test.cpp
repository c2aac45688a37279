// The program as people and scripts use it: exit codes, streams, messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "common/file.hpp"
#include "common/image.hpp"
#include "common/version.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

struct Outcome {
    int exitCode = -1;
    std::string out, err;
};

// Pictures of 8 x 6 pixels: `grey` at depth 5; `tie` has another colour in one pixel; `moved` another colour
// and a nearer depth in one; `hole` no surface in one.
class CompareProgram : public testing::Test {
  protected:
    void SetUp() override {
        ColorImage color(8, 6, 3);
        DepthImage depth(8, 6, 1);
        for (float& z : depth.pixels) z = 5;
        write("grey", color, depth);
        color.at(2, 3)[1] = 9;
        write("tie", color, depth);
        *depth.at(2, 3) = 4.5f;
        write("moved", color, depth);
        *depth.at(2, 3) = 0;
        write("hole", color, depth);
        write("small", ColorImage(4, 4, 3), DepthImage(4, 4, 1));
    }

    // Arguments as typed in the directory of the pictures.
    Outcome run(const std::string& arguments) const {
        const std::string command =
            "cd '" + directory_.path("") + "' && '" IWALK_COMPARE "' " + arguments + " >out.txt 2>err.txt";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1,
                *readWholeFile(directory_.path("out.txt"), 1 << 20),
                *readWholeFile(directory_.path("err.txt"), 1 << 20)};
    }

    void expectError(const std::string& arguments, const std::string& reason) const {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exitCode, 2) << arguments;
        EXPECT_THAT(outcome.out, IsEmpty()) << arguments;
        EXPECT_THAT(outcome.err, HasSubstr(reason)) << arguments;
        EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << "one line: " << outcome.err;
    }

    void writeBytes(const std::string& name, std::span<const std::byte> bytes) const {
        ASSERT_TRUE(
            replaceFile(directory_.path(name), {reinterpret_cast<const char*>(bytes.data()), bytes.size()})
                .ok());
    }
    void write(const std::string& name, const ColorImage& color, const DepthImage& depth) const {
        writeBytes(name + ".png", *encodePng(color));
        writeBytes(name + ".exr", *encodeExr(depth));
    }

    TempDirectory directory_;
};

TEST_F(CompareProgram, ByDefaultPicturesMustBeIdentical) {
    EXPECT_EQ(run("grey.png grey.png").exitCode, 0);
    EXPECT_EQ(run("grey.png grey.png --depth grey.exr grey.exr").exitCode, 0);
    EXPECT_EQ(run("grey.png tie.png").exitCode, 1);
    EXPECT_EQ(run("grey.png grey.png --depth grey.exr hole.exr").exitCode, 1);
    EXPECT_EQ(run("--depth grey.exr tie.exr grey.png tie.png").exitCode, 1);
}

TEST_F(CompareProgram, LimitsAllowWhatTheySay) {
    EXPECT_EQ(run("grey.png tie.png --different 1").exitCode, 0);
    EXPECT_EQ(run("grey.png tie.png --different 2.1%").exitCode, 0);  // 1 of 48 pixels is 2.08 %
    EXPECT_EQ(run("grey.png tie.png --different 2%").exitCode, 1);
    EXPECT_EQ(run("grey.png tie.png --depth grey.exr tie.exr --ties 1").exitCode, 0);
    EXPECT_EQ(run("grey.png moved.png --depth grey.exr moved.exr --ties 1").exitCode, 1);
}

TEST_F(CompareProgram, ToleranceAsksForTheDepthRangeOnly) {
    EXPECT_EQ(run("grey.png tie.png --depth grey.exr tie.exr --tolerance 1").exitCode, 0);
    EXPECT_EQ(run("grey.png tie.png --depth grey.exr tie.exr --tolerance 1 --different 0").exitCode, 1);
    const std::string moved = "grey.png moved.png --depth grey.exr moved.exr --tolerance 0.5";
    EXPECT_EQ(run(moved).exitCode, 1);
    EXPECT_EQ(run(moved + " --outside 1").exitCode, 0);
    EXPECT_EQ(run(moved + " --outside 1 --see-through 0").exitCode, 0);
    EXPECT_EQ(run(moved + " --depth-slack 0.11").exitCode, 0);
    const std::string hole = "grey.png hole.png --depth grey.exr hole.exr --tolerance 0.5 --outside 50%";
    EXPECT_EQ(run(hole).exitCode, 0);
    EXPECT_EQ(run(hole + " --see-through 0").exitCode, 1);
}

TEST_F(CompareProgram, ReportsInTextAndJson) {
    const Outcome text = run("grey.png hole.png --depth grey.exr hole.exr --tolerance 1");
    EXPECT_EQ(text.exitCode, 1);
    EXPECT_THAT(text.out, HasSubstr("1 (2.083 %) outside the reference's depths in 3 x 3 px"));
    EXPECT_THAT(text.out, HasSubstr("not within what was asked: 1 pixels are outside"));
    EXPECT_THAT(run("grey.png grey.png").out, HasSubstr("\nwithin what was asked\n"));

    const Outcome json = run("grey.png hole.png --depth grey.exr hole.exr --tolerance 1 --json");
    EXPECT_EQ(json.exitCode, 1);
    const auto report = nlohmann::json::parse(json.out);
    EXPECT_EQ(report["range"]["outside_pixels"], 1);
    EXPECT_EQ(report["range"]["see_through_pixels"], 1);
    EXPECT_EQ(report["within"], false);
}

TEST_F(CompareProgram, ErrorsAreOneLineAndExitCode2) {
    expectError("", "--help");
    expectError("grey.png", "TEST");
    expectError("grey.png grey.png --bananas", "--bananas");
    expectError("grey.png grey.png grey.png", "grey.png");
    expectError("grey.png missing.png", "missing.png");
    expectError("grey.png grey.exr", "grey.exr");
    expectError("grey.png small.png", "small.png");
    expectError("grey.png grey.png --depth grey.exr small.exr", "small.exr");
    expectError("grey.png grey.png --depth grey.exr", "--depth");
    expectError("grey.png grey.png --tolerance 1", "--depth");
    expectError("grey.png grey.png --ties 1", "--depth");
    expectError("grey.png grey.png --outside 1", "--tolerance");
    expectError("grey.png grey.png --different lots", "--different");
    expectError("grey.png grey.png --depth grey.exr grey.exr --tolerance nan", "--tolerance");
    expectError("grey.png grey.png --depth grey.exr grey.exr --tolerance -1", "--tolerance");
    expectError("grey.png grey.png --depth grey.exr grey.exr --tolerance 1 --depth-slack 2", "--depth-slack");
}

TEST_F(CompareProgram, WhatIsNoDepthIsRefused) {
    for (const float wrong : {-1.0f, INFINITY, NAN}) {
        DepthImage depth(8, 6, 1);
        *depth.at(7, 5) = wrong;
        writeBytes("wrong.exr", *encodeExr(depth));
        expectError("grey.png grey.png --depth grey.exr wrong.exr", "wrong.exr");
    }
}

TEST_F(CompareProgram, HelpAndVersion) {
    const Outcome help = run("--help");
    EXPECT_EQ(help.exitCode, 0);
    EXPECT_THAT(help.out, HasSubstr("Exit codes"));
    const Outcome version = run("--version");
    EXPECT_EQ(version.exitCode, 0);
    EXPECT_THAT(version.out, HasSubstr(kVersion));
}

}  // namespace
}  // namespace iwalk
