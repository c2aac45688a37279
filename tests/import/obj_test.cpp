#include <gmock/gmock.h>

#include <cmath>

#include "tests/import/import_fixture.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kGrey = 0xffcccccc, kRed = 0xff0000ff, kHalfGreen = 0xff008000;
const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

class ObjTest : public ImportTest {
  protected:
    Imported imported(const std::string& contents) {
        auto result = importText("model.obj", contents);
        EXPECT_TRUE(result.ok()) << result.error().message;
        return result.ok() ? std::move(*result) : Imported();
    }
    // x + 10 y + 100 z of all corners, triangle by triangle.
    std::vector<std::vector<double>> shape(const std::string& contents) {
        std::vector<std::vector<double>> out;
        for (const Triangle& t : imported(contents).triangles) {
            out.emplace_back();
            for (const Corner& c : t)
                out.back().push_back(c.position.x + 10 * c.position.y + 100 * c.position.z);
        }
        return out;
    }
    std::vector<std::uint32_t> colors(const std::string& contents) {
        std::vector<std::uint32_t> out;
        for (const Triangle& t : imported(contents).triangles) {
            EXPECT_TRUE(t[0].color == t[1].color && t[1].color == t[2].color);
            out.push_back(t[0].color);
        }
        return out;
    }
    void expectError(const std::string& contents, const std::string& error) {
        EXPECT_EQ(errorOf("bad.obj", contents), error);
    }

    const std::vector<std::vector<double>> fannedSquare_ = {{0, 1, 11}, {0, 11, 10}};
};

TEST_F(ObjTest, everyFormOfACorner) {
    const std::string others = "vt 0 0\nvn 0 0 1\n";
    EXPECT_EQ(shape(kSquare + "f 1 2 3 4\n"), fannedSquare_);
    EXPECT_EQ(shape(kSquare + others + "f 1/1 2/1 3/1 4/1\n"), fannedSquare_);
    EXPECT_EQ(shape(kSquare + others + "f 1//1 2//1 3//1 4//1\n"), fannedSquare_);
    EXPECT_EQ(shape(kSquare + others + "f 1/1/1 2/1/1 3/1/1 4/1/1\n"), fannedSquare_);
    EXPECT_EQ(shape(kSquare + others + "f -4/-1/-1 -3 -2//-1 -1/-1\n"), fannedSquare_);
    EXPECT_EQ(shape(kSquare + "f 1/ 2// 3 4\n"), fannedSquare_);
}

TEST_F(ObjTest, linesAsPeopleWriteThem) {
    EXPECT_EQ(shape("# a comment \\\n" + kSquare + "f 1 2 3 4"), fannedSquare_);
    EXPECT_EQ(shape("\xef\xbb\xbf" + kSquare + "f 1 2 \\\n  3\\\n 4 # so\n"), fannedSquare_);
    EXPECT_EQ(shape("v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nf 1 2 \\\r\n3 4\r\n"), fannedSquare_);
    EXPECT_EQ(shape("o a\n\n  v\t0 0  0 \nv 1 0 0 1.0\nv 1 1 0#c\nv +0. 1e0 -0\ng b\ns 1\n f  1\t2 3  4 \\"),
              fannedSquare_);
    EXPECT_EQ(shape("f 1 2 3 4\nl 1 2\np 1\nvp 1\n" + kSquare), fannedSquare_);
    EXPECT_EQ(shape(kSquare + "f\nf 1\nf 1 2\nf 1 2 3 4\n"), fannedSquare_);
}

TEST_F(ObjTest, negativeNumbersCountBackFromTheFace) {
    EXPECT_EQ(shape("v 1 0 0\nv 2 0 0\nv 3 0 0\nf -3 -2 -1\nv 4 0 0\nf -3 -2 -1\n"),
              (std::vector<std::vector<double>>{{1, 2, 3}, {2, 3, 4}}));
}

TEST_F(ObjTest, summary) {
    const Imported model = imported(kSquare + "vn 0 0 1\nf 1 2 3 4\nf 1 2 3\nv nan 0 0\nf 1 2 5\n");
    EXPECT_EQ(model.summary.vertices, 4u);
    EXPECT_EQ(model.vertices.size(), 4u);
    EXPECT_EQ(model.summary.triangleBound, 4u);
    EXPECT_EQ(model.summary.bounds, (ModelBox{glm::dvec3(0), glm::dvec3(1, 1, 0)}));
    EXPECT_TRUE(model.summary.normals);
    EXPECT_FALSE(model.summary.colors);
    EXPECT_EQ(model.counts.triangles, 3u);
    EXPECT_EQ(model.counts.droppedNonFinite, 1u);
    EXPECT_EQ(model.progress, (std::vector<double>{1, 1})) << "too short for more";
}

TEST_F(ObjTest, precisionIsOfFloatsUnlessTheModelIsFarAway) {
    EXPECT_EQ(imported("v 0 0 0\nv 3 0 0\n").summary.precision, std::ldexp(1, 1 - 23));
    EXPECT_EQ(imported("v 1020 0 0\nv 1023 0 0\n").summary.precision, std::ldexp(1, 9 - 23));
    EXPECT_EQ(imported("v 1e6 0 0\nv 1000001 0 0\n").summary.precision, std::ldexp(1, 19 - 52));
}

TEST_F(ObjTest, normals) {
    const Imported model = imported(kSquare + "vn 0 3 4\nvn 0 0 0\nvn nan 0 1\nf 1//1 2//2 3//3\nf 1 2 3\n");
    const glm::vec3 given(0, 0.6f, 0.8f), face(0, 0, 1);
    ASSERT_EQ(model.triangles.size(), 2u);
    EXPECT_EQ(model.triangles[0][0].normal, given);
    EXPECT_EQ(model.triangles[0][1].normal, face);
    EXPECT_EQ(model.triangles[0][2].normal, face);
    EXPECT_EQ(model.triangles[1][0].normal, face);
    EXPECT_EQ(imported(kSquare + "f 1 2 3\n").triangles[0][0].normal, glm::vec3(0));
}

TEST_F(ObjTest, vertexColors) {
    const Imported model = imported("v 0 0 0 1 0 0\nv 1 0 0 0 .5 0\nv 1 1 0 -1 2 nan\nv 0 1 0\nf 1 2 3 4\n");
    EXPECT_TRUE(model.summary.colors);
    ASSERT_EQ(model.triangles.size(), 2u);
    EXPECT_EQ(model.triangles[0][0].color, kRed);
    EXPECT_EQ(model.triangles[0][1].color, kHalfGreen);
    EXPECT_EQ(model.triangles[0][2].color, 0xff00ff00u);
    EXPECT_EQ(model.triangles[1][2].color, kGrey);
}

TEST_F(ObjTest, materials) {
    directory_.write(
        "a.mtl",
        "newmtl red\r\nKa 1 1 1\r\nKd 2 0 -1\r\nd 0.5\r\nnewmtl with blank\nKd 0 .5 0\nnewmtl none\nTr 1\n");
    const std::string faces =
        "f 1 2 3\nusemtl red\nf 1 2 3\nusemtl with blank \nf 1 2 3\nusemtl none\nf 1 2 3\nusemtl unknown\nf "
        "1 2 3\n";
    const std::vector<std::uint32_t> expected = {kGrey, kRed, kHalfGreen, kGrey, kGrey};
    EXPECT_EQ(colors("mtllib a.mtl\n" + kSquare + faces), expected);
    EXPECT_EQ(colors(kSquare + faces + "mtllib a.mtl\n"), expected) << "the library may come last";
    EXPECT_EQ(colors("mtllib nothing.mtl  a.mtl \n" + kSquare + faces), expected);
    EXPECT_TRUE(imported("mtllib a.mtl\n" + kSquare).summary.colors);

    std::filesystem::create_directory(directory_.path("sub"));
    directory_.write("sub/a b.mtl", "newmtl red\nKd 1\nnewmtl spectral\nKd spectral x.rfl\n");
    EXPECT_EQ(colors("mtllib sub\\a b.mtl\n" + kSquare + faces)[1], 0xffffffffu);
}

TEST_F(ObjTest, aMissingLibraryIsNoError) {
    const Imported model = imported("mtllib nowhere.mtl\n" + kSquare + "usemtl a\nf 1 2 3\n");
    EXPECT_FALSE(model.summary.colors);
    EXPECT_EQ(model.triangles.size(), 1u);
    EXPECT_EQ(model.triangles[0][0].color, 0u);
}

TEST_F(ObjTest, librariesOutsideTheFolderAreNotRead) {
    std::filesystem::create_directory(directory_.path("model"));
    directory_.write("secret.mtl", "newmtl red\nKd 1 0 0\n");
    for (const std::string& name :
         {std::string("../secret.mtl"), directory_.path("secret.mtl"), std::string("./../secret.mtl"),
          std::string("..\\secret.mtl"), std::string("x/../../secret.mtl"), std::string("C:\\secret.mtl")}) {
        directory_.write("model/m.obj", fmt::format("mtllib {}\n{}usemtl red\nf 1 2 3\n", name, kSquare));
        const auto model = import("model/m.obj");
        ASSERT_TRUE(model.ok()) << model.error().message;
        EXPECT_FALSE(model->summary.colors) << name;
    }
}

TEST_F(ObjTest, aBadLibraryIsNoError) {
    directory_.write("bad.mtl", "newmtl red\nKd 1 0 0\nKd x\n" + std::string(std::size_t{3} << 20, 'x'));
    std::filesystem::create_directory(directory_.path("directory.mtl"));
    EXPECT_EQ(colors("mtllib bad.mtl directory.mtl\n" + kSquare + "usemtl red\nf 1 2 3\n"),
              std::vector{kRed});
}

TEST_F(ObjTest, spilledVerticesGiveTheSameTriangles) {
    std::string text;
    constexpr unsigned kCount = 40000;
    for (unsigned i = 0; i < kCount; ++i)
        text += fmt::format("v {} {} {}\nvn {} 1 0\n", i, i * 0.25, i % 5, i);
    for (unsigned i = 0; i < 30000; ++i) {
        const unsigned a = i + 1, b = i * 7919 % kCount + 1, c = (i * i) % kCount + 1;
        text += fmt::format("f {}//{} {}//{} {}//{}\n", a, b, b, c, c, a);
    }
    directory_.write("model.obj", text);
    const auto tiny = import("model.obj", 0), large = import("model.obj", std::uint64_t{64} << 20);
    ASSERT_TRUE(tiny.ok()) << tiny.error().message;
    ASSERT_TRUE(large.ok()) << large.error().message;
    EXPECT_EQ(tiny->triangles.size(), 30000u);
    EXPECT_TRUE(tiny->triangles == large->triangles);
}

TEST_F(ObjTest, errorsNameTheLine) {
    expectError("v 1 2\n", "line 1: a vertex needs three numbers, not ''");
    expectError(kSquare + "v 1 x 3\n", "line 5: a vertex needs three numbers, not 'x 3'");
    expectError(kSquare + "vn 1 2 \\\n\n", "line 5: a normal needs three numbers, not ''");
    expectError(kSquare + "f 1 2 3\nf 1 2 5\n",
                "line 6: face 2: vertex index 5, but there are 4 vertices, 4 of them up to here");
    expectError("v 0 0 0\nf 1 -2 1\n" + kSquare,
                "line 2: face 1: vertex index -2, but there are 5 vertices, 1 of them up to here");
    expectError(kSquare + "f 0 1 2\n",
                "line 5: face 1: vertex index 0, but there are 4 vertices, 4 of them up to here");
    expectError(kSquare + "f 1//1 2 3\n",
                "line 5: face 1: normal index 1, but there are 0 normals, 0 of them up to here");
    expectError(kSquare + "f 1 2 3x\n",
                "line 5: face 1: '3x' is no corner: v, v/vt, v//vn or v/vt/vn is wanted");
    expectError(kSquare + "f 1 2 9999999999999999999\n",
                "line 5: face 1: '9999999999999999999' is no corner: v, v/vt, v//vn or v/vt/vn is wanted");
}

TEST_F(ObjTest, whatIsNoObj) {
    expectError("", "is empty");
    expectError("\n\n", "has no vertices ('v' lines): not an OBJ model?");
    expectError(std::string(100, '\0'), "has no vertices ('v' lines): not an OBJ model?");
    expectError(kSquare + std::string(std::size_t{5} << 20, 'f'),
                "line 5: does not end within 1048576 bytes: not a text file?");
    std::string joined = kSquare;
    for (int i = 0; i < 20; ++i) joined += std::string(std::size_t{100} << 10, ' ') + "\\\n";
    expectError(joined, "line 5: is longer than 1048576 bytes, with those it goes on in");
    expectError("\xff\xfev", "is UTF-16 text (byte 0): save it as UTF-8");
}

TEST_F(ObjTest, noTruncationCrashes) {
    directory_.write("a.mtl", "newmtl a\nKd 1 0 0\n");
    const std::string text =
        "mtllib a.mtl\n" + kSquare + "vn 0 0 1\nvt 0 0\nusemtl a\nf 1//1 2//-1 \\\n3/1/1 -1\n";
    for (std::size_t size = 0; size <= text.size(); ++size) (void)errorOf("cut.obj", text.substr(0, size));
}

}  // namespace
}  // namespace iwalk
