#include "common/token.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/common/temp_directory.hpp"

namespace iwalk {
namespace {

class Token : public ::testing::Test {
  protected:
    Result<std::string> read(const std::string& contents, mode_t mode = 0600) {
        directory_.write("token", contents);
        EXPECT_EQ(::chmod(directory_.path("token").c_str(), mode), 0);
        return readToken(directory_.path("token"));
    }
    const TempDirectory directory_;
};

TEST_F(Token, IsTheFilesLine) {
    EXPECT_EQ(read("0123456789abcdef\n").value(), "0123456789abcdef");
    EXPECT_EQ(read("0123456789abcdef+/=").value(), "0123456789abcdef+/=");
    EXPECT_TRUE(read(std::string(256, 'x'), 0640).ok());
}

TEST_F(Token, WhatIsNoneIsRefused) {
    for (const std::string& bad :
         {std::string(), std::string("short"), std::string(257, 'x'), std::string("0123456789 abcdef"),
          std::string("0123456789abcdef\n\n"), std::string("0123456789abcdef\x80"), std::string(5000, 'x')})
        EXPECT_NE(read(bad).ok() ? "" : read(bad).error().message, "") << bad;
    const auto open = read("0123456789abcdef\n", 0644);
    ASSERT_FALSE(open.ok());
    EXPECT_NE(open.error().message.find("chmod"), std::string::npos);
    EXPECT_FALSE(readToken(directory_.path("nothing")).ok());
}

TEST_F(Token, Comparison) {
    EXPECT_TRUE(sameToken("", ""));
    EXPECT_TRUE(sameToken("0123456789abcdef", "0123456789abcdef"));
    for (const char* other : {"", "0123456789abcde", "0123456789abcdeg", "1123456789abcdef",
                              "0123456789abcdef0", "0123456789abcdef0123456789abcdef"})
        EXPECT_FALSE(sameToken("0123456789abcdef", other)) << other;
    EXPECT_FALSE(sameToken("", "x"));
}

}  // namespace
}  // namespace iwalk
