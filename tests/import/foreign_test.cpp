// Files that libraries read, in the program iwalk-import: it must lie beside this one.
#include <gmock/gmock.h>

#include "preprocess/import/exchange.hpp"
#include "preprocess/import/height_ramp.hpp"
#include "preprocess/import/import_process.hpp"
#include "tests/import/import_fixture.hpp"

namespace iwalk {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

class ForeignTest : public ImportTest {
  protected:
    Result<Imported> importHeights(const std::string& name, const ImportChoices& choices) {
        Imported out;
        ASSIGN_OR_RETURN(const auto importer,
                         openImporter(directory_.path(name), {kMemory, directory_.path(""), choices}));
        const TriangleSink triangles = [&](std::span<const Triangle> batch) {
            out.triangles.insert(out.triangles.end(), batch.begin(), batch.end());
            return Result<void>();
        };
        ASSIGN_OR_RETURN(out.summary, importer->scan({}, {}));
        ASSIGN_OR_RETURN(out.counts, importer->triangles(triangles, {}));
        return out;
    }
    static constexpr std::uint64_t kMemory = std::uint64_t{256} << 20;
};

const std::string kOff = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 2.5\n3 0 1 2\n3 0 2 3\n";

// One triangle in a buffer of 36 bytes, two nodes that show it, one inside the other; base colour red / 2.
const std::string kGltf = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
  "nodes": [{"mesh": 0, "translation": [10, 0, 0], "children": [1]}, {"mesh": 0, "scale": [2, 2, 2], "translation": [0, 5, 0]}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
  "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0, 0, 1]}}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0,0,0], "max": [1,1,0]}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}],
  "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";

TEST_F(ForeignTest, off) {
    directory_.write("a.off", kOff);
    const auto read = import("a.off", kMemory);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read->counts.triangles, 2u);
    EXPECT_EQ(read->summary.triangleBound, 2u);
    EXPECT_EQ(read->summary.bounds.max, glm::dvec3(1, 1, 2.5));
    EXPECT_EQ(read->vertices.size(), 6u);
}

TEST_F(ForeignTest, gltfNodesAndColors) {
    directory_.write("a.gltf", kGltf);
    const auto read = import("a.gltf", kMemory);
    ASSERT_TRUE(read.ok()) << read.error().message;
    ASSERT_EQ(read->triangles.size(), 2u);
    EXPECT_EQ(read->triangles[0][1].position, glm::dvec3(11, 0, 0));
    EXPECT_EQ(read->triangles[1][2].position, glm::dvec3(10, 7, 0));
    EXPECT_TRUE(read->summary.colors);
    EXPECT_EQ(read->triangles[0][0].color, 0xff0000bc);  // half of linear red is 188 in sRGB
}

TEST_F(ForeignTest, badFilesEndInOneLine) {
    EXPECT_EQ(errorOf("a.xyz", "just text"), "unknown kind of model: there is no reader for '.xyz' files");
    EXPECT_EQ(errorOf("a", "just text"), "unknown kind of model: there is no reader for '' files");
    EXPECT_THAT(errorOf("a.off", kOff.substr(0, 12)),
                AnyOf(HasSubstr("cannot be read"), HasSubstr("has no meshes")));
    EXPECT_THAT(errorOf("a.glb", "glTF and rubbish"), HasSubstr("cannot be read"));
    EXPECT_THAT(errorOf("a.tif", "II*\0rubbish"), HasSubstr("cannot be read as an image of heights"));
}

// A file may name others, but only in its folder.
TEST_F(ForeignTest, otherFoldersAreNotRead) {
    std::filesystem::create_directory(directory_.path("inner"));
    std::string text = kGltf;
    const std::size_t uri = text.find("data:"), end = text.find('"', uri);
    text.replace(uri, end - uri, "../outside.bin");
    directory_.write("outside.bin", std::string(36, '\0'));
    directory_.write("inner/a.gltf", text);
    EXPECT_FALSE(import("inner/a.gltf", kMemory).ok());
    directory_.write("a.gltf", text.replace(text.find("../outside.bin"), 3, ""));
    EXPECT_TRUE(import("a.gltf", kMemory).ok());
}

TEST_F(ForeignTest, limitsOfTheProgram) {
    directory_.write("a.off", kOff);
    const auto run = [&](const ImportProcessLimits& limits) {
        const auto output = SpillFile::create(directory_.path(""));
        const auto done =
            runImportProcess(directory_.path("a.off"), false, limits, **output, directory_.path(""));
        return done ? std::string() : done.error().message;
    };
    EXPECT_EQ(run({kMemory, 1 << 20, 10, 100}), "");
    std::string large = "OFF\n200000 1 0\n";
    for (int i = 0; i < 200'000; ++i) large += "0 0 0\n";
    directory_.write("a.off", large + "3 0 1 2\n");
    EXPECT_THAT(run({1 << 20, 1 << 20, 10, 100}), AnyOf(HasSubstr("memory"), HasSubstr("crashed")));
    directory_.write("a.off", kOff);
    EXPECT_THAT(run({kMemory, 100, 10, 100}), HasSubstr("too many for a file of its size"));
    EXPECT_THAT(run({kMemory, 1 << 20, 10, 0}), HasSubstr("took longer than 0 s"));
}

TEST_F(ForeignTest, whatTheProgramWritesIsChecked) {
    const auto file = SpillFile::create(directory_.path(""));
    ExchangeWriter writer((*file)->descriptor());
    const std::vector<Triangle> triangles(3);
    ASSERT_TRUE(writer.header({}).ok());
    ASSERT_TRUE(writer.block(std::as_bytes(std::span(triangles))).ok());
    ASSERT_TRUE(writer.finish().ok());
    const std::string name = "a";
    const auto blocks = [&]() -> Result<std::size_t> {
        ExchangeReader reader(**file, name);
        if (auto header = reader.header(); !header) return header.error();
        for (std::size_t bytes = 0;;) {
            ASSIGN_OR_RETURN(const auto block, reader.block());
            if (block.empty()) return bytes;
            bytes += block.size();
        }
    };
    EXPECT_EQ(blocks().value(), sizeof(Triangle) * 3);
    // Any byte but the header's flags and sizes.
    const std::uint64_t end = sizeof(ExchangeHeader) + 2 * sizeof(ExchangeBlock) + 3 * sizeof(Triangle);
    for (std::uint64_t at = 0; at < end; at += 7) {
        if (at >= 8 && at < sizeof(ExchangeHeader)) continue;
        std::byte byte{};
        ASSERT_TRUE((*file)->readAt(at, std::span(&byte, 1)).ok());
        const std::byte flipped = ~byte;
        ASSERT_TRUE((*file)->writeAt(at, std::span(&flipped, 1)).ok());
        EXPECT_FALSE(blocks().ok()) << at;
        ASSERT_TRUE((*file)->writeAt(at, std::span(&byte, 1)).ok());
    }
}

void append(std::string& out, std::initializer_list<std::uint32_t> numbers, std::size_t bytes) {
    for (const std::uint32_t number : numbers) out.append(reinterpret_cast<const char*>(&number), bytes);
}

// A TIFF file of samples of 16 bits, the first row the farthest.
std::string tiff(std::uint32_t columns, std::uint32_t rows, const std::vector<std::uint32_t>& samples) {
    static constexpr std::uint32_t kShort = 3, kLong = 4, kEntries = 9, kData = 8 + 2 + 12 * kEntries + 4;
    std::string out = "II";
    append(out, {42}, 2);
    append(out, {8}, 4);
    append(out, {kEntries}, 2);
    const auto entry = [&](std::uint32_t tag, std::uint32_t type, std::uint32_t value) {
        append(out, {tag, type}, 2);
        append(out, {1, value}, 4);
    };
    entry(256, kLong, columns);
    entry(257, kLong, rows);
    entry(258, kShort, 16);    // bits
    entry(259, kShort, 1);     // not compressed
    entry(262, kShort, 1);     // 0 is black
    entry(273, kLong, kData);  // where they are
    entry(277, kShort, 1);     // channels
    entry(278, kLong, rows);   // in one piece
    entry(279, kLong, 2 * columns * rows);
    append(out, {0}, 4);
    for (const std::uint32_t sample : samples) append(out, {sample}, 2);
    return out;
}

TEST_F(ForeignTest, heightMaps) {
    directory_.write("a.tif", tiff(3, 2, {100, 200, 65535, 0, 1, 2}));
    ImportChoices choices;
    choices.spacing = 10, choices.heightScale = 0.5;
    const auto read = importHeights("a.tif", choices);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read->triangles.size(), 4u);
    EXPECT_EQ(read->summary.bounds.min, glm::dvec3(0, 0, 0));
    EXPECT_EQ(read->summary.bounds.max, glm::dvec3(20, 10, 32767.5));
    const Triangle& t = read->triangles[0];
    EXPECT_EQ(t[0].position, glm::dvec3(0, 0, 0));
    EXPECT_EQ(t[1].position, glm::dvec3(10, 0, 0.5));
    EXPECT_EQ(t[2].position, glm::dvec3(10, 10, 100));
}

TEST_F(ForeignTest, heightMapsWithHoles) {
    directory_.write("a.tif", tiff(3, 2, {5, 5, 9, 5, 5, 5}));
    ImportChoices choices;
    choices.noData = 9;
    EXPECT_EQ(importHeights("a.tif", choices)->triangles.size(), 3u);
    directory_.write("a.tif", tiff(3, 2, {5, 9, 5, 5, 9, 5}));
    EXPECT_EQ(importHeights("a.tif", choices)->triangles.size(), 0u);
}

TEST_F(ForeignTest, heightMapsWithASea) {
    directory_.write("a.tif", tiff(3, 2, {0, 100, 200, 50, 101, 300}));
    ImportChoices choices;
    EXPECT_FALSE(importHeights("a.tif", choices)->summary.colors);
    choices.heightScale = 2, choices.seaLevel = 200;
    const auto read = importHeights("a.tif", choices);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_TRUE(read->summary.colors);
    const auto blue = [](std::uint32_t color) { return color >> 16 & 255; };
    for (const Triangle& triangle : read->triangles) {
        for (const Corner& corner : triangle) {
            const double z = corner.position.z;
            const std::uint32_t red = corner.color & 255, green = corner.color >> 8 & 255;
            EXPECT_EQ(corner.color >> 24, 255u);
            EXPECT_EQ(blue(corner.color) > green && green > red, z <= 200) << z;
            EXPECT_EQ(corner.color == 0xfff8f8f8, z == 600) << z;  // the highest
            EXPECT_EQ(corner.color == 0xff5c2a10, z == 0) << z;    // the deepest
        }
    }
    // A sea without depths.
    const HeightRamp flat(5, 5, 9);
    EXPECT_EQ(flat.color(5), 0xffe0c896);
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_EQ(HeightRamp(5, -infinite, 9).color(7), 0xff4e8a54);
}

TEST_F(ForeignTest, badHeightMaps) {
    const std::string whole = tiff(30, 30, std::vector<std::uint32_t>(900, 7));
    EXPECT_THAT(errorOf("a.tif", whole.substr(0, 400)), HasSubstr("cut short"));
    EXPECT_THAT(errorOf("a.tif", tiff(1, 3, {1, 2, 3})), HasSubstr("2 x 2 to"));
    EXPECT_NE(errorOf("a.tif", tiff(2'000'000'000, 2'000'000'000, {1})), "");
}

}  // namespace
}  // namespace iwalk
