#include "preprocess/import/assembly.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/import/import_fixture.hpp"

namespace iwalk {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A triangle in the plane z = 0, with and without colours and normals.
const std::string kTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string kColored = "v 0 0 5 1 0 0\nv 1 0 5 1 0 0\nv 0 1 5 1 0 0\nf 1 2 3\n";
const std::string kNormals = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

std::string parts(const std::string& entries) {
    return fmt::format("{{\"parts\": [{}]}}", entries);
}
std::string moved(const std::string& file, int x, const std::string& more = "") {
    return fmt::format(R"({{"file": "{}", "matrix": [1,0,0,{}, 0,1,0,0, 0,0,1,0, 0,0,0,1]{}}})", file, x,
                       more);
}

class AssemblyTest : public ImportTest {
  protected:
    AssemblyTest() {
        directory_.write("a.ply", kTriangle);
        directory_.write("red.obj", kColored);
        directory_.write("n.obj", kNormals);
    }
    Imported read(const std::string& entries) {
        const auto result = importText("all.json", parts(entries));
        EXPECT_TRUE(result.ok()) << result.error().message;
        return result.ok() ? *result : Imported{};
    }
    std::vector<double> firstX(const std::string& entries) {
        std::vector<double> x;
        for (const Triangle& t : read(entries).triangles) x.push_back(t[0].position.x);
        return x;
    }
    std::string refused(const std::string& entries) { return errorOf("all.json", parts(entries)); }
};

TEST_F(AssemblyTest, placesFiles) {
    EXPECT_THAT(firstX(moved("a.ply", 3) + "," + moved("red.obj", 4) + "," + moved("./a.ply", 5)),
                ElementsAre(3, 5, 4));
    const Imported read = this->read(moved("a.ply", 3) + R"(,{"file": "a.ply"})");
    EXPECT_EQ(read.summary.bounds.max, glm::dvec3(4, 1, 0));
    EXPECT_EQ(read.summary.vertices, 6u);
    EXPECT_EQ(read.vertices.size(), 6u);
    EXPECT_EQ(read.counts.triangles, 2u);
    EXPECT_EQ(read.summary.triangleBound, 0u);  // as of a text PLY: not known
    EXPECT_FALSE(read.summary.colors || read.summary.normals);
}

TEST_F(AssemblyTest, triangleBound) {
    EXPECT_EQ(read(moved("n.obj", 3) + "," + moved("n.obj", 4)).summary.triangleBound, 2u);
    EXPECT_EQ(read(moved("n.obj", 3) + "," + moved("a.ply", 4)).summary.triangleBound, 0u);
}

TEST_F(AssemblyTest, matricesAreRowByRow) {
    const Imported read =
        this->read(R"({"file": "a.ply", "matrix": [0,-2,0,10, 2,0,0,20, 0,0,2,30, 0,0,0,1]})");
    ASSERT_EQ(read.triangles.size(), 1u);
    EXPECT_EQ(read.triangles[0][0].position, glm::dvec3(10, 20, 30));
    EXPECT_EQ(read.triangles[0][1].position, glm::dvec3(10, 22, 30));
    EXPECT_EQ(read.triangles[0][2].position, glm::dvec3(8, 20, 30));
}

TEST_F(AssemblyTest, mirroredTrianglesKeepTheirFront) {
    const Imported read = this->read(R"({"file": "n.obj", "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]})");
    ASSERT_EQ(read.triangles.size(), 1u);
    const Triangle& t = read.triangles[0];
    EXPECT_EQ(t[0].normal, glm::vec3(0, 0, 1));
    const glm::dvec3 face = glm::cross(t[1].position - t[0].position, t[2].position - t[0].position);
    EXPECT_GT(face.z, 0);
}

TEST_F(AssemblyTest, normalsFollowTheSurface) {
    // Sheared: z grows with x, so the plane's normal leans back.
    const Imported read = this->read(R"({"file": "n.obj", "matrix": [1,0,0,0, 0,1,0,0, 1,0,1,0, 0,0,0,1]})");
    const glm::vec3 n = read.triangles[0][0].normal;
    EXPECT_NEAR(n.x, -std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(n.z, std::sqrt(0.5), 1e-6);
    // A part without normals gets those of its faces.
    EXPECT_EQ(this->read(moved("n.obj", 0) + "," + moved("a.ply", 2)).triangles[1][0].normal,
              glm::vec3(0, 0, 1));
}

TEST_F(AssemblyTest, colors) {
    const auto colorsOf = [&](const std::string& entries) {
        std::vector<std::uint32_t> out;
        for (const Triangle& t : read(entries).triangles) out.push_back(t[2].color);
        return out;
    };
    EXPECT_THAT(colorsOf(moved("a.ply", 0)), ElementsAre(0));
    EXPECT_THAT(colorsOf(moved("a.ply", 0) + "," + moved("red.obj", 0)),
                ElementsAre(kPlainColor, 0xff0000ff));
    EXPECT_THAT(colorsOf(moved("red.obj", 0, R"(,"color":"#0080fF")")), ElementsAre(0xffff8000));
    EXPECT_THAT(colorsOf(moved("a.ply", 0, R"(,"color":"#000000")") + "," + moved("a.ply", 1)),
                ElementsAre(0xff000000, kPlainColor));
}

TEST_F(AssemblyTest, assembliesStandInOneAnother) {
    directory_.write("pair.json", parts(moved("a.ply", 1) + "," + moved("a.ply", 2)));
    EXPECT_THAT(firstX(moved("pair.json", 10) + "," + moved("pair.json", 20)), ElementsAre(11, 12, 21, 22));
    const auto self = importText("all.json", parts(moved("all.json", 0)));
    ASSERT_FALSE(self.ok());
    EXPECT_THAT(self.error().message, HasSubstr("does one name itself?"));
}

TEST_F(AssemblyTest, placingWithoutEndIsRefused) {
    std::string many = moved("a.ply", 0);
    for (int i = 0; i < 200; ++i) many += fmt::format(",{}", moved("a.ply", i));
    directory_.write("b0.json", parts(many));
    for (int level = 1; level < 5; ++level) {
        std::string entries = moved(fmt::format("b{}.json", level - 1), 0);
        for (int i = 0; i < 200; ++i)
            entries += fmt::format(",{}", moved(fmt::format("b{}.json", level - 1), i));
        directory_.write(fmt::format("b{}.json", level), parts(entries));
    }
    const auto result = import("b4.json");
    ASSERT_FALSE(result.ok());
    EXPECT_THAT(result.error().message, HasSubstr("places more than"));
}

TEST_F(AssemblyTest, filesAreReadOnceForAllPlacements) {
    // More files than may stay open: each is opened twice, however often it is placed.
    std::string entries;
    for (int i = 0; i < 300; ++i) {
        const std::string name = fmt::format("part-{}.ply", i % 30);
        if (i < 30) directory_.write(name, kTriangle);
        entries += fmt::format("{}{}", i > 0 ? "," : "", moved(name, i));
    }
    const Imported read = this->read(entries);
    EXPECT_EQ(read.counts.triangles, 300u);
    EXPECT_EQ(read.summary.bounds.max.x, 300);
}

TEST_F(AssemblyTest, bad) {
    EXPECT_EQ(errorOf("all.json", "{"), "is no JSON text");
    EXPECT_EQ(errorOf("all.json", "[]"), "is no assembly: it has no list \"parts\"");
    EXPECT_EQ(errorOf("all.json", "{\"parts\": 3}"), "is no assembly: it has no list \"parts\"");
    EXPECT_EQ(refused(""), "has no parts");
    EXPECT_EQ(refused("3"), "part 0: must be an object with \"file\"");
    EXPECT_EQ(refused("{}"), "part 0: \"file\" must name a file");
    EXPECT_EQ(refused(R"({"file": 7})"), "part 0: \"file\" must name a file");
    EXPECT_THAT(refused(R"({"file": "a.ply", "scale": 2})"), HasSubstr("'scale' means nothing here"));
    for (const char* matrix :
         {"[1]", "7", "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,\"1\"]", "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1e999]"})
        EXPECT_NE(refused(fmt::format(R"({{"file": "a.ply", "matrix": {}}})", matrix)), "") << matrix;
    EXPECT_THAT(refused(R"({"file": "a.ply", "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]})"),
                HasSubstr("the last row"));
    for (const char* color : {"\"red\"", "\"#12345\"", "\"#12345g\"", "7", "[1,0,0]"})
        EXPECT_THAT(refused(fmt::format(R"({{"file": "a.ply", "color": {}}})", color)), HasSubstr("#rrggbb"))
            << color;
    EXPECT_THAT(importText("all.json", parts(moved("missing.ply", 0))).error().message,
                HasSubstr("missing.ply"));
}

TEST_F(AssemblyTest, outOfRange) {
    const Imported read =
        this->read(R"({"file": "red.obj", "matrix": [1,0,0,1e308, 0,1,0,1e308, 0,0,1e308,0, 0,0,0,1]})");
    EXPECT_EQ(read.counts.triangles, 0u);
    EXPECT_EQ(read.counts.droppedNonFinite, 1u);
}

}  // namespace
}  // namespace iwalk
