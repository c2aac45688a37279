#include "common/settings.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace iwalk {
namespace {

std::string refusal(const std::string& name, const std::string& text) {
    Settings settings;
    const Result<void> set = setSetting(settings, name, text);
    return set.ok() ? "" : set.error().message;
}

TEST(Settings, TableNamesEverySetting) {
    std::vector<std::string> names;
    for (const SettingInfo& info : settingTable()) names.emplace_back(info.name);
    EXPECT_EQ(names,
              (std::vector<std::string>{"cache", "fetch-threads", "shading", "ramp", "background", "near",
                                        "level", "mode", "occlusion", "plp-budget", "plp-rays", "show",
                                        "max-fps", "preview-fps", "preview-size", "preview-rate"}));
}

TEST(Settings, DefaultsAreWhatTheHelpSays) {
    const Settings settings;
    for (const SettingInfo& info : settingTable()) {
        std::string text = settingText(settings, info.name);
        if (text.starts_with('#')) text = text.substr(1);
        EXPECT_NE(std::string(info.help).find("default " + text), std::string::npos)
            << info.name << " " << text;
    }
}

TEST(Settings, TextIsReadBack) {
    Settings settings;
    for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
             {"cache", "512M"},       {"cache", "65537"},        {"fetch-threads", "64"},
             {"shading", "smooth"},   {"shading", "flat"},       {"ramp", "height"},
             {"ramp", "none"},        {"background", "#203040"}, {"near", "0.1"},
             {"level", "full"},       {"level", "12"},           {"mode", "plp"},
             {"mode", "frustum"},     {"mode", "cplp"},          {"occlusion", "queries"},
             {"show", "overdraw"},    {"plp-budget", "70000"},   {"plp-rays", "0.05"},
             {"max-fps", "0"},        {"max-fps", "59.94"},      {"preview-fps", "0"},
             {"preview-fps", "12.5"}, {"preview-size", "320"},   {"preview-rate", "64k"}}) {
        ASSERT_TRUE(setSetting(settings, name, text).ok()) << name << " " << text;
        EXPECT_EQ(settingText(settings, name), text);
    }
    EXPECT_EQ(settings.cacheBytes, 65537u);
    EXPECT_EQ(settings.background, 0x203040u);
    EXPECT_EQ(settings.near, 0.1);
    EXPECT_EQ(settings.shading, Shading::flat);
    EXPECT_EQ(settings.level, 12);
    ASSERT_TRUE(setSetting(settings, "background", "ffffff").ok());
    EXPECT_EQ(settings.background, 0xffffffu);
}

TEST(Settings, RefusalsNameTheSettingAndWhatIsRight) {
    EXPECT_NE(refusal("shading", "shiny").find("shading = 'shiny': choose flat"), std::string::npos);
    EXPECT_NE(refusal("cachet", "1G").find("cache, fetch-threads"), std::string::npos);
    for (const char* bad : {"", "512", "-1", "1.5G", "99999999999T"})
        EXPECT_NE(refusal("cache", bad), "") << bad;
    for (const char* bad : {"", "0", "65", "-1", "2 ", "two"})
        EXPECT_NE(refusal("fetch-threads", bad), "") << bad;
    for (const char* bad : {"", "red", "12345", "1234567", "##123456", "-12345"}) {
        EXPECT_NE(refusal("background", bad), "") << bad;
    }
    for (const char* bad : {"", "-1", "nan", "inf", "1e999", "1e16", "1m"})
        EXPECT_NE(refusal("near", bad), "") << bad;
    for (const char* bad : {"", "-1", "255", "256", "1.5", "finest"})
        EXPECT_NE(refusal("level", bad), "") << bad;
    EXPECT_NE(refusal("ramp", "HEIGHT"), "");
    EXPECT_NE(refusal("mode", "all").find("frustum, plp or cplp"), std::string::npos);
    for (const char* bad : {"", "0", "999", "-70000", "70k", "1e6"})
        EXPECT_NE(refusal("plp-budget", bad), "") << bad;
    for (const char* bad : {"", "0", "-1", "nan", "inf", "10.1", "0.1%"})
        EXPECT_NE(refusal("plp-rays", bad), "") << bad;
    for (const char* bad : {"", "-1", "61", "nan", "five"}) EXPECT_NE(refusal("preview-fps", bad), "") << bad;
    for (const char* bad : {"", "15", "4097", "1.5"}) EXPECT_NE(refusal("preview-size", bad), "") << bad;
    for (const char* bad : {"", "0", "1023", "-1"}) EXPECT_NE(refusal("preview-rate", bad), "") << bad;
}

TEST(Settings, WhatIsNotLiveStaysWhileServersRun) {
    Settings settings;
    EXPECT_TRUE(changeSetting(settings, "mode", "plp").ok());
    EXPECT_EQ(settings.mode, Mode::plp);
    EXPECT_TRUE(changeSetting(settings, "cache", "1G").ok());  // as it is
    const Result<void> refused = changeSetting(settings, "cache", "2G");
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().message.find("--cache 2G"), std::string::npos);
    EXPECT_EQ(settings.cacheBytes, Settings().cacheBytes);
    EXPECT_FALSE(changeSetting(settings, "mode", "all").ok());
    EXPECT_EQ(settings.mode, Mode::plp);
}

TEST(Settings, WhatDoesNotGoTogetherIsRefused) {
    Settings settings;
    EXPECT_FALSE(changeSetting(settings, "show", "priority").ok());
    EXPECT_EQ(settings.show, Show::none);
    ASSERT_TRUE(changeSetting(settings, "mode", "plp").ok());
    ASSERT_TRUE(changeSetting(settings, "show", "priority").ok());
    EXPECT_FALSE(changeSetting(settings, "mode", "frustum").ok());
    EXPECT_EQ(settings.mode, Mode::plp);
}

TEST(Settings, ARefusalChangesNothing) {
    Settings settings;
    EXPECT_FALSE(setSetting(settings, "cache", "nonsense").ok());
    EXPECT_EQ(settings.cacheBytes, Settings().cacheBytes);
}

TEST(ParseBytes, BinaryFactors) {
    EXPECT_EQ(parseBytes("1048576").value(), 1048576u);
    EXPECT_EQ(parseBytes("64k").value(), 65536u);
    EXPECT_EQ(parseBytes("64K").value(), 65536u);
    EXPECT_EQ(parseBytes("512M").value(), 512u << 20);
    EXPECT_EQ(parseBytes("2G").value(), std::uint64_t{2} << 30);
    EXPECT_EQ(parseBytes("0").value(), 0u);
    EXPECT_EQ(parseBytes("18446744073709551615").value(), std::numeric_limits<std::uint64_t>::max());
    EXPECT_EQ(parseBytes("16777215T").value(), std::uint64_t{16777215} << 40);
}

TEST(ParseBytes, Refusals) {
    for (const char* bad : {"", "k", "M", "-1", "+1", " 1", "1 ", "1.5G", "1GB", "0x10",
                            "18446744073709551616", "16777216T", "18446744073709551615k"}) {
        EXPECT_FALSE(parseBytes(bad).ok()) << bad;
    }
}

TEST(FormatBytes, AtMostFourDigits) {
    EXPECT_EQ(formatBytes(0), "0 B");
    EXPECT_EQ(formatBytes(1023), "1023 B");
    EXPECT_EQ(formatBytes(1024), "1 KB");
    EXPECT_EQ(formatBytes(1536), "1.5 KB");
    EXPECT_EQ(formatBytes((1u << 20) - 1), "1 MB");
    EXPECT_EQ(formatBytes(1000u << 20), "1000 MB");
    EXPECT_EQ(formatBytes(std::uint64_t{3} << 29), "1.5 GB");
    EXPECT_EQ(formatBytes(std::numeric_limits<std::uint64_t>::max()), "16 EB");
}

}  // namespace
}  // namespace iwalk
