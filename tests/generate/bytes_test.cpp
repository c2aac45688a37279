// The same bytes on every machine: what is measured on one can be measured on another.
#include <gtest/gtest.h>

#include "common/file.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/generate/generated.hpp"

namespace iwalk {
namespace {

// FNV-1a, 64 bits.
std::uint64_t hashOf(const std::string& bytes) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
    return hash;
}

std::string bytesFor(const std::string& scene, std::uint64_t seed) {
    const TempDirectory directory;
    generate(scene, 20'000, directory.path("a.ply"), seed);
    return readWholeFile(directory.path("a.ply"), 1u << 30).value();
}

class BytesTest : public testing::TestWithParam<std::pair<const char*, std::uint64_t>> {};

// When a scene is changed on purpose, its number changes too: write the new one here, and say so in the
// changes.
TEST_P(BytesTest, AreGolden) {
    const auto [scene, golden] = GetParam();
    EXPECT_EQ(hashOf(bytesFor(scene, 1)), golden) << std::hex << hashOf(bytesFor(scene, 1));
}

TEST_P(BytesTest, DependOnTheSeedAlone) {
    const std::string scene = GetParam().first;
    EXPECT_TRUE(bytesFor(scene, 7) == bytesFor(scene, 7));
    const std::string a = bytesFor(scene, 7), b = bytesFor(scene, 8);
    EXPECT_FALSE(a.substr(a.find("end_header")) == b.substr(b.find("end_header")));
}

INSTANTIATE_TEST_SUITE_P(Scenes, BytesTest,
                         testing::Values(std::pair{"sphere", std::uint64_t{0x03ef6e3f30c82321}},
                                         std::pair{"plant", std::uint64_t{0x30e2e4df4c4a50e2}},
                                         std::pair{"isosurface", std::uint64_t{0x5a17ec53247b8232}}),
                         [](const auto& scene) { return std::string(scene.param.first); });

}  // namespace
}  // namespace iwalk
