#include "preprocess/import/number.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>

namespace iwalk {
namespace {

// The number that all of `text` is; fails when it is none.
double parsed(const std::string& text) {
    double value = -12345;
    const char* const end = parseNumber(text.c_str(), value);
    EXPECT_EQ(end, text.c_str() + text.size()) << text;
    return value;
}

TEST(NumberTest, agreesWithTheLibrary) {
    for (const char* text : {"0",
                             "-0",
                             "1",
                             "+1.5",
                             "-2.",
                             ".5",
                             "1e5",
                             "1E-5",
                             "2.e1",
                             "+3.1e+2",
                             "123456789012345678",
                             "1234567890123456789012",
                             "0.000000000000000000000000123",
                             "9007199254740993",
                             "1e22",
                             "1e23",
                             "1e-22",
                             "1e-23",
                             "1.7976931348623157e308",
                             "4.9e-324",
                             "3.4028235e38",
                             "0.1000000000000000055511151231257827",
                             "00012.50"}) {
        EXPECT_EQ(parsed(text), std::strtod(text, nullptr)) << text;
    }
}

TEST(NumberTest, agreesWithTheLibraryOnRandomNumbers) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 100000; ++i) {
        const std::uint64_t bits = random();
        double value = 0;
        std::memcpy(&value, &bits, sizeof value);
        if (!std::isfinite(value)) continue;
        ASSERT_EQ(parsed(fmt::format("{}", value)), value);
        const double modest = static_cast<double>(static_cast<std::int64_t>(bits)) * 0x1p-40;
        for (const std::string& text : {fmt::format("{:.6f}", modest), fmt::format("{:.9g}", modest)}) {
            ASSERT_EQ(parsed(text), std::strtod(text.c_str(), nullptr)) << text;
        }
    }
}

TEST(NumberTest, whatIsNotFinite) {
    for (const char* text : {"nan", "NaN", "-nan", "nan(ind)", "-1.#IND", "1.#QNAN", "1.#QNAN0", "-1.#INF"}) {
        EXPECT_TRUE(std::isnan(parsed(text))) << text;
    }
    EXPECT_EQ(parsed("inf"), HUGE_VAL);
    EXPECT_EQ(parsed("-Infinity"), -HUGE_VAL);
}

TEST(NumberTest, whatIsOutOfRange) {
    EXPECT_EQ(parsed("1e309"), HUGE_VAL);
    EXPECT_EQ(parsed("-1e99999"), -HUGE_VAL);
    EXPECT_EQ(parsed(std::string(400, '9')), HUGE_VAL);
    EXPECT_EQ(parsed("1e-400"), 0.0);
    EXPECT_EQ(parsed(fmt::format("0.{:0400}1", 0)), 0.0);
    EXPECT_EQ(parsed(fmt::format(".{:0400}1", 0)), 0.0);
}

TEST(NumberTest, stopsBehindTheNumber) {
    double value = 0;
    for (const char* text : {"1.5 2", "1.5/2", "1.5x", "1.5\n", "1.5e", "1.5-", "1.5e+x"}) {
        EXPECT_EQ(parseNumber(text, value), text + 3) << text;
        EXPECT_EQ(value, 1.5) << text;
    }
}

TEST(NumberTest, whatIsNone) {
    double value = 0;
    for (const char* text : {"", "\n", "x", "-", "+-1", "--1", ".", "e5", "-.e1", "#IND", " 1"}) {
        EXPECT_EQ(parseNumber(text, value), nullptr) << text;
    }
}

}  // namespace
}  // namespace iwalk
