#include <gmock/gmock.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <cstring>

#include "common/file.hpp"
#include "preprocess/import/vrml_importer.hpp"
#include "tests/import/import_fixture.hpp"

namespace iwalk {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kHead = "#VRML V2.0 utf8\n";
const std::string kPoints = "coord Coordinate { point [0 0 0, 1 0 0, 1 1 0, 0 1 0] }";
const std::string kSet = "IndexedFaceSet { " + kPoints + " coordIndex [0 1 2 -1] }";

std::string shape(const std::string& geometry, const std::string& appearance = "NULL") {
    return "Shape { geometry " + geometry + " appearance " + appearance + " }\n";
}
std::string material(const std::string& rgb) {
    return "Appearance { material Material { shininess 0.5 diffuseColor " + rgb + " transparency 0 } }";
}

class VrmlTest : public ImportTest {
  protected:
    VrmlTest() { spdlog::set_level(spdlog::level::off); }
    ~VrmlTest() override { spdlog::set_level(spdlog::level::info); }

    Imported read(const std::string& text) {
        const auto result = importText("a.wrl", kHead + text);
        EXPECT_TRUE(result.ok()) << result.error().message;
        return result.ok() ? *result : Imported{};
    }
    std::string refused(const std::string& text) { return errorOf("a.wrl", kHead + text); }

    // The first corner of each triangle, to three places.
    std::vector<std::string> firstCorners(const std::string& text) {
        std::vector<std::string> out;
        for (const Triangle& t : read(text).triangles) {
            const glm::dvec3& p = t[0].position;
            const auto rounded = [](double v) { return std::round(v * 1000) / 1000 + 0.0; };
            out.push_back(fmt::format("{} {} {}", rounded(p.x), rounded(p.y), rounded(p.z)));
        }
        return out;
    }
    std::vector<std::string> colors(const std::string& text) {
        std::vector<std::string> out;
        for (const Triangle& t : read(text).triangles) {
            for (const Corner& c : t) out.push_back(fmt::format("{:08x}", c.color));
        }
        return out;
    }
};

TEST_F(VrmlTest, polygonsAreFanned) {
    const Imported read =
        this->read(shape("IndexedFaceSet { " + kPoints + " coordIndex [0 1 2 3 -1, 0,1,2] }"));
    ASSERT_EQ(read.triangles.size(), 3u);
    EXPECT_EQ(read.triangles[1][0].position, glm::dvec3(0, 0, 0));
    EXPECT_EQ(read.triangles[1][1].position, glm::dvec3(1, 1, 0));
    EXPECT_EQ(read.triangles[1][2].position, glm::dvec3(0, 1, 0));
    EXPECT_EQ(read.summary.vertices, 4u);
    EXPECT_EQ(read.summary.triangleBound, 3u);
    EXPECT_FALSE(read.summary.colors || read.summary.normals);
}

TEST_F(VrmlTest, transformsNest) {
    const std::string point =
        "IndexedFaceSet { coord Coordinate { point [1 2 3, 0 0 0, 1 0 0] } coordIndex [0 1 2] }";
    EXPECT_THAT(firstCorners("Transform { translation 10 0 0 children Transform { scale 2 2 2 children [ " +
                             shape(point) + " ] } }"),
                ElementsAre("12 4 6"));
    EXPECT_THAT(firstCorners("Transform { rotation 0 0 1 1.5707963267948966 children " + shape(point) + " }"),
                ElementsAre("-2 1 3"));
    // Turned about a centre; stretched along an axis turned by 90 degrees.
    EXPECT_THAT(firstCorners("Transform { center 1 0 0 rotation 0 0 1 3.14159265358979 children " +
                             shape(point) + " }"),
                ElementsAre("1 -2 3"));
    EXPECT_THAT(firstCorners("Transform { scale 3 1 1 scaleOrientation 0 0 1 1.5707963267948966 children " +
                             shape(point) + " }"),
                ElementsAre("1 6 3"));
}

TEST_F(VrmlTest, fieldsMayComeInAnyOrder) {
    EXPECT_THAT(firstCorners("Transform { children [ " + shape(kSet) + " ] translation 5 0 0 }"),
                ElementsAre("5 0 0"));
    EXPECT_THAT(firstCorners(
                    shape("IndexedFaceSet { coordIndex [1 2 3] creaseAngle 1 solid FALSE " + kPoints + " }")),
                ElementsAre("1 0 0"));
}

TEST_F(VrmlTest, nodesAreUsedAgain) {
    EXPECT_THAT(
        firstCorners("DEF A Transform { translation 1 0 0 children DEF B " + shape("DEF S " + kSet) +
                     " }\nTransform { translation 0 3 0 children [ USE A USE B " + shape("USE S") + " ] }"),
        ElementsAre("1 0 0", "1 3 0", "0 3 0", "0 3 0"));
    // Only the coordinates; and a definition inside what is left out.
    EXPECT_THAT(
        firstCorners(shape("IndexedLineSet { coord DEF C Coordinate { point [7 0 0, 1 0 0, 1 1 0] } }") +
                     shape("IndexedFaceSet { coord USE C coordIndex [0 1 2] }")),
        ElementsAre("7 0 0"));
    // The last definition before the use counts.
    EXPECT_THAT(firstCorners("Switch { choice DEF A " + shape(kSet) +
                             " } DEF A Transform { translation 2 0 0 children " + shape(kSet) + " } USE A"),
                ElementsAre("2 0 0", "2 0 0"));
}

class CountingFile : public RandomAccessFile {
  public:
    CountingFile(std::string text, std::uint64_t& bytesRead)
        : text_(std::move(text)), bytesRead_(bytesRead) {}
    Result<void> readAt(std::uint64_t offset, std::span<std::byte> out) const override {
        std::memcpy(out.data(), text_.data() + offset, out.size());
        bytesRead_ += out.size();
        return {};
    }
    std::uint64_t size() const override { return text_.size(); }

  private:
    std::string text_;
    std::uint64_t& bytesRead_;
};

// What is used stands far away, and little is read there.
TEST_F(VrmlTest, usingNodesReadsLittle) {
    constexpr std::uint64_t kUses = 3000, kBytesAUse = 16384;
    std::string text = kHead + shape(kSet, "DEF A " + material("1 0 0"));
    for (std::uint64_t use = 0; use < kUses; ++use) text += shape(kSet, "USE A");
    ASSERT_GT(text.size(), 300'000u);
    std::uint64_t bytesRead = 0;
    const auto importer =
        openVrml("a.wrl", std::make_unique<CountingFile>(text, bytesRead), {16u << 20, directory_.path("")});
    ASSERT_TRUE(importer.ok());
    const auto summary = (*importer)->scan({}, {});
    ASSERT_TRUE(summary.ok()) << summary.error().message;
    EXPECT_EQ(summary->triangleBound, kUses + 1);
    EXPECT_LE(bytesRead, text.size() + kUses * kBytesAUse);
}

TEST_F(VrmlTest, choices) {
    const auto moved = [](int x) {
        return fmt::format("Transform {{ translation {} 0 0 children {} }} ", x, shape(kSet));
    };
    EXPECT_THAT(firstCorners("Switch { choice [ " + moved(1) + moved(2) + " ] whichChoice 1 }"),
                ElementsAre("2 0 0"));
    EXPECT_THAT(firstCorners("Switch { choice [ " + moved(1) + moved(2) + " ] }"), ElementsAre());
    EXPECT_THAT(firstCorners("LOD { range [ 1 ] level [ DEF X " + moved(1) + moved(2) + " ] } " + moved(3)),
                ElementsAre("1 0 0", "3 0 0"));
    EXPECT_THAT(
        firstCorners("Group { children [ NULL Anchor { url \"a } b\" children " + moved(4) + " } ] }"),
        ElementsAre("4 0 0"));
}

TEST_F(VrmlTest, materialsGiveColors) {
    EXPECT_THAT(colors(shape(kSet, material("1 0.5 0"))), ElementsAre("ff0080ff", "ff0080ff", "ff0080ff"));
    EXPECT_THAT(colors(shape(kSet, "DEF P " + material("0 0 1")) + shape(kSet, "USE P") + shape(kSet)),
                ElementsAre("ffff0000", "ffff0000", "ffff0000", "ffff0000", "ffff0000", "ffff0000",
                            "ffc8c8c8", "ffc8c8c8", "ffc8c8c8"));
    EXPECT_TRUE(read(shape(kSet, material("2 -1 nan"))).summary.colors);
}

TEST_F(VrmlTest, colorNodes) {
    const std::string set = "IndexedFaceSet { " + kPoints +
                            " coordIndex [0 1 2 -1 0 2 3 -1] color Color { color [1 0 0, 0 1 0, "
                            "0 0 1, 0 0 0] } ";
    const char *r = "ff0000ff", *g = "ff00ff00", *b = "ffff0000", *k = "ff000000";
    EXPECT_THAT(colors(shape(set + "}")), ElementsAre(r, g, b, r, b, k));
    EXPECT_THAT(colors(shape(set + "colorIndex [3 3 3 -1 0 1 0 -1] }")), ElementsAre(k, k, k, r, g, r));
    EXPECT_THAT(colors(shape(set + "colorPerVertex FALSE }")), ElementsAre(r, r, r, g, g, g));
    EXPECT_THAT(colors(shape(set + "colorPerVertex FALSE colorIndex [2 0] }")),
                ElementsAre(b, b, b, r, r, r));
    EXPECT_THAT(refused(shape(set + "colorIndex [3 3 3] }")),
                HasSubstr("a corner of this IndexedFaceSet has no colour"));
    EXPECT_THAT(refused(shape(set + "colorIndex [4 3 3 -1 0 1 0 -1] }")), HasSubstr("no colour"));
    EXPECT_THAT(refused(shape(set + "colorPerVertex FALSE colorIndex [2] }")), HasSubstr("a face of this"));
}

TEST_F(VrmlTest, orientation) {
    const Imported clockwise = read(shape("IndexedFaceSet { ccw FALSE " + kPoints + " coordIndex [0 1 2] }"));
    EXPECT_EQ(clockwise.triangles[0][0].position, glm::dvec3(1, 1, 0));
    const Imported mirrored = read("Transform { scale -1 1 1 children " + shape(kSet) + " }");
    EXPECT_EQ(mirrored.triangles[0][0].position, glm::dvec3(-1, 1, 0));
}

TEST_F(VrmlTest, whatIsNoFaceSetIsPassedOver) {
    EXPECT_THAT(
        firstCorners("# a comment { [\nPROTO P [ field SFNode n NULL ] { Shape { geometry Box {} } }\n"
                     "EXTERNPROTO Q [ ] \"q.wrl\"\nEXTERNPROTO R [ ] [ \"r.wrl\" ]\nViewpoint { description "
                     "\"look \\\" } \" }\nDEF T TimeSensor { }\nROUTE T.a TO T.b\nP { n Group {} }\n" +
                     shape("Box { size 1 1 1 }") + shape(kSet)),
        ElementsAre("0 0 0"));
}

TEST_F(VrmlTest, bad) {
    EXPECT_THAT(errorOf("a.wrl", "#VRML V1.0 ascii\n"), HasSubstr("is VRML 1.0"));
    EXPECT_THAT(errorOf("a.wrl", "\x1f\x8b\x08 "), HasSubstr("is compressed"));
    EXPECT_THAT(errorOf("a.wrl", "Shape {}"), HasSubstr("does not begin with"));
    EXPECT_EQ(errorOf("a.wrl", ""), "is empty");
    EXPECT_EQ(refused("\nShape { geometry IndexedFaceSet { " + kPoints + " coordIndex [0 1 4] } }"),
              "line 3: coordIndex 4 of this IndexedFaceSet, but it has 4 points");
    EXPECT_THAT(refused(shape("IndexedFaceSet { coordIndex [0 1 2] }")), HasSubstr("but it has 0 points"));
    EXPECT_THAT(refused(shape("IndexedFaceSet { coord Coordinate { point [0 0 0 1] } }")),
                HasSubstr("no multiple of three"));
    EXPECT_THAT(refused(shape("IndexedFaceSet { coord Coordinate { point [0 0 x] } }")),
                HasSubstr("line 2: a number is wanted"));
    EXPECT_THAT(refused(shape("IndexedFaceSet { coordIndex [0 1.5] }")),
                HasSubstr("a whole number is wanted"));
    EXPECT_THAT(refused(shape("IndexedFaceSet { coordIndex [99999999999] }")),
                HasSubstr("a whole number is wanted"));
    EXPECT_THAT(refused("Transform { translation 1 2 children [] }"), HasSubstr("a number is wanted"));
    EXPECT_THAT(refused("USE nothing"), HasSubstr("USE 'nothing', but nothing has that name"));
    EXPECT_THAT(refused("} "), HasSubstr("a node is wanted here"));
    EXPECT_THAT(refused("Shape ["), HasSubstr("a '{' is wanted behind 'Shape'"));
    EXPECT_THAT(refused("Shape { geometry " + std::string(5000, 'x')), HasSubstr("a word does not end"));
}

TEST_F(VrmlTest, nodesThatUseThemselves) {
    EXPECT_THAT(refused("DEF A Group { children [ USE A ] }"), HasSubstr("does one use itself?"));
    // Twice as many at each step: it must end.
    std::string bomb = "DEF A0 Group { children [] }\n";
    for (int i = 1; i < 60; ++i)
        bomb += fmt::format("DEF A{} Group {{ children [ USE A{} USE A{} ] }}\n", i, i - 1, i - 1);
    EXPECT_THAT(refused(bomb), HasSubstr("nodes are used more than 100000 times"));
    std::string deep;
    for (int i = 0; i < 300; ++i) deep += "Group { children ";
    EXPECT_NE(refused(deep), "");
}

TEST_F(VrmlTest, cutShortAnywhere) {
    const std::string whole = shape(kSet, material("1 0 0"));
    for (std::size_t length = 1; length + 2 < whole.size(); ++length) {
        if (whole.substr(0, length).find_first_not_of(' ') == std::string::npos) continue;
        EXPECT_NE(refused(whole.substr(0, length)), "") << length;
    }
}

TEST_F(VrmlTest, moreThanMemoryHolds) {
    std::string text = kHead + "Shape { geometry IndexedFaceSet { coord Coordinate { point [";
    for (int i = 0; i < 400'000; ++i) text += "0 0 0,";
    directory_.write("a.wrl", text + "] } } }");
    const auto result = import("a.wrl");
    ASSERT_FALSE(result.ok());
    EXPECT_THAT(result.error().message, HasSubstr("give more --memory"));
}

TEST_F(VrmlTest, notFinite) {
    const Imported read =
        this->read(shape("IndexedFaceSet { coord Coordinate { point [0 0 0, 1 nan 0, 1 1 0, 0 1 0] } "
                         "coordIndex [0 1 2 -1 0 2 3 -1] }"));
    EXPECT_EQ(read.counts.triangles, 1u);
    EXPECT_EQ(read.counts.droppedNonFinite, 1u);
    EXPECT_EQ(read.summary.vertices, 3u);
}

}  // namespace
}  // namespace iwalk
