#include <gmock/gmock.h>

#include "tests/import/import_fixture.hpp"
#include "tests/import/ply_writer.hpp"

namespace iwalk {
namespace {

const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "property list uchar int vertex_indices\n";

std::string ascii(const std::string& elements, const std::string& data) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + data;
}
std::string oneTriangle(const std::string& faces) {
    return ascii("element vertex 3\n" + kXyz + "element face 1\n" + kFaces, "0 0 0\n1 0 0\n0 1 0\n" + faces);
}

class BadPlyTest : public ImportTest {
  protected:
    void expectError(const std::string& contents, const std::string& error) {
        EXPECT_EQ(errorOf("bad.ply", contents), error);
    }
};

TEST_F(BadPlyTest, headersThatAreNone) {
    expectError("", "is empty");
    expectError("plx\n", "does not begin with a line 'ply': not a PLY file");
    expectError("ply", "does not begin with a line 'ply': not a PLY file");
    expectError("ply\nformat ascii 1.0\n", "header without end_header (line 2): the file is cut short");
    expectError("ply\nformat ascii 1.0\n" + std::string(std::size_t{3} << 20, 'x'),
                "no end_header in the first 1048576 bytes: not a PLY file");
    expectError("ply\nend_header\n", "header line 2: no format line in the header");
}

TEST_F(BadPlyTest, headerLines) {
    expectError(
        "ply\nformat utf8 1.0\n",
        "header line 2: unknown format 'utf8': ascii, binary_little_endian and binary_big_endian are known");
    expectError("ply\nformat ascii 2.0\n", "header line 2: unknown format version '2.0': only 1.0 is known");
    expectError("ply\nformat ascii 1.0\nformat ascii 1.0\n", "header line 3: a second format line");
    expectError(ascii("element vertex -1\n", ""),
                "header line 3: element 'vertex' has the count '-1': a whole number from 0 on is wanted");
    expectError(ascii("element vertex 99999999999999999999\n", ""),
                "header line 3: element 'vertex' has the count '99999999999999999999': a whole number from 0 "
                "on is wanted");
    expectError(ascii("element vertex 1\nelement vertex 1\n", ""),
                "header line 4: a second element 'vertex'");
    expectError(ascii("element vertex 1\nelement\x1b[2J 1\n", ""),
                "header line 4: unknown keyword 'element?[2J'");
    expectError(ascii("property int x\n", ""), "header line 3: a property before the first element");
    expectError(ascii("element vertex 1\nproperty quad x\n", ""), "header line 4: unknown type 'quad'");
    expectError(ascii("element vertex 1\nproperty int\n", ""), "header line 4: a property without a name");
    expectError(ascii("element vertex 1\nproperty int x\nproperty float x\n", ""),
                "header line 5: a second property 'x'");
    expectError(ascii("element face 1\nproperty list float int a\n", ""),
                "header line 4: a list's length cannot be of type 'float'");
}

TEST_F(BadPlyTest, hostileNumbersOfElementsAndProperties) {
    std::string elements, properties = "element vertex 1\n";
    for (int i = 0; i < 300; ++i) elements += "element e" + std::to_string(i) + " 0\n";
    for (int i = 0; i < 1100; ++i) properties += "property int p" + std::to_string(i) + "\n";
    expectError(ascii(elements, ""), "header line 259: more than 256 elements");
    expectError(ascii(properties, ""), "header line 1028: more than 1024 properties");
}

TEST_F(BadPlyTest, elementsThatAreNotThere) {
    expectError(ascii("element face 0\n" + kFaces, ""), "header has no element vertex: no positions to read");
    expectError(ascii("element vertex 1\nproperty float x\nproperty float y\n", "0 0\n"),
                "element 'vertex' lacks a number x, y or z: no positions to read");
    expectError(
        ascii("element vertex 0\nproperty list uchar float x\nproperty float y\nproperty float z\n", ""),
        "element 'vertex' lacks a number x, y or z: no positions to read");
    expectError(ascii("element vertex 1\n" + kXyz + "element face 1\nproperty int a\n", "0 0 0\n0\n"),
                "element 'face' has no list vertex_indices: no triangles to read");
    expectError(
        ascii("element vertex 1\n" + kXyz + "element face 1\nproperty list uchar float vertex_indices\n",
              "0 0 0\n0\n"),
        "'vertex_indices' is not a list of whole numbers: no triangles to read");
    expectError(ascii("element vertex 1\n" + kXyz + "element tristrips 1\n" + kFaces, "0 0 0\n3 0 0 0\n"),
                "triangle strips (element tristrips) are not supported: save the model with faces");
}

TEST_F(BadPlyTest, countsThatTheFileHasNoRoomFor) {
    const std::string header = "ply\nformat binary_little_endian 1.0\n";
    expectError(
        header + "element vertex 18446744073709551615\n" + kXyz + "end_header\n" + std::string(36, '\0'),
        "header promises 18446744073709551615 of element 'vertex', the file has room for 3: it is cut short "
        "or "
        "damaged");
    expectError(
        header + "element vertex 1\n" + kXyz + "element face 4000000000\n" + kFaces + "end_header\n" +
            std::string(17, '\0'),
        "header promises 4000000000 of element 'face', the file has room for 5: it is cut short or damaged");
    expectError(ascii("element vertex 3\n" + kXyz, "0 0 0\n1 0"),
                "header promises 3 of element 'vertex', the file has room for 1: it is cut short or damaged");
}

TEST_F(BadPlyTest, lists) {
    expectError(oneTriangle("-3 0 1 2\n"), "element 'face' 0: a list of length -3 (byte 172)");
    expectError(oneTriangle("1e300 0 1 2\n"),
                "element 'face' 0: a list of 1e+300 items in a file with 7 bytes left (byte 172)");
    expectError(oneTriangle("nan 0 1 2\n"), "element 'face' 0: a list of length nan (byte 172)");
    expectError(oneTriangle("4 0 1 2\n"), "element 'face' 0: the file ends, it is cut short (byte 180)");
    expectError(oneTriangle("2.5 0 1\n"), "element 'face' 0: a list of length 2.5 (byte 172)");
}

TEST_F(BadPlyTest, indices) {
    expectError(oneTriangle("3 0 1 3\n"),
                "element 'face' 0: vertex index 3, but there are 3 vertices (byte 178)");
    expectError(oneTriangle("3 0 1 -1\n"),
                "element 'face' 0: vertex index -1, but there are 3 vertices (byte 178)");
    expectError(oneTriangle("3 0 1 0.5\n"),
                "element 'face' 0: vertex index 0.5, but there are 3 vertices (byte 178)");
    TestMesh mesh = testCube();
    mesh.polygons[2] = {0, 1, 4294967295u};
    for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
        EXPECT_THAT(
            errorOf("bad.ply", writePly(mesh, {.format = format})),
            testing::StartsWith("element 'face' 2: vertex index -1, but there are 8 vertices (byte "));
        EXPECT_THAT(errorOf("bad.ply", writePly(mesh, {.format = format, .index = "uint"})),
                    testing::StartsWith(
                        "element 'face' 2: vertex index 4294967295, but there are 8 vertices (byte "));
    }
}

TEST_F(BadPlyTest, words) {
    expectError(oneTriangle("3 0 x\x01y 2\n"), "element 'face' 0: 'x?y' is not a number (byte 176)");
    expectError(oneTriangle("3 0 1/2 2\n"), "element 'face' 0: '1/2' is not a number (byte 176)");
    const std::string word(600, '1');
    expectError(oneTriangle("3 0 " + word + " 2\n"),
                "element 'face' 0: '" + word.substr(0, 40) + "...' is not a number (byte 176)");
}

TEST_F(BadPlyTest, theElementAndTheByteOfAShortFile) {
    std::string text = writePly(testCube(), {});
    const std::size_t lastFace = text.size() - 17;
    text.resize(text.size() - 1);
    EXPECT_EQ(errorOf("bad.ply", text),
              fmt::format("element 'face' 4: the file ends, it is cut short (byte {})", lastFace));
}

TEST_F(BadPlyTest, whatIsNoFile) {
    EXPECT_EQ(import("nowhere.ply").ok(), false);
    const auto directory = openImporter(directory_.path(""), {});
    ASSERT_FALSE(directory.ok());
    EXPECT_EQ(directory.error().message, directory_.path("") + ": is a directory: give a model file");
    const auto device = openImporter("/dev/zero", {});
    ASSERT_FALSE(device.ok());
    EXPECT_EQ(device.error().message, "/dev/zero: is not a regular file: give a model file");
    EXPECT_EQ(errorOf("model.xyz", "solid"), "unknown kind of model: there is no reader for '.xyz' files");
}

// Every part of a file is an error, except that a text may lack its last line end.
TEST_F(BadPlyTest, everyTruncation) {
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        for (const bool extras : {false, true}) {
            PlyFlavor flavor{.format = format, .color = "uchar", .normals = true};
            flavor.extras = flavor.vertexLists = extras;
            flavor.reversed = extras;  // indices come last, one digit
            const std::string text = writePly(testCube(), flavor);
            const std::size_t complete = text.size() - (flavor.format == "ascii" ? 1 : 0);
            for (std::size_t size = 0; size < complete; ++size) {
                ASSERT_NE(errorOf("cut.ply", text.substr(0, size)), "") << format << " cut to " << size;
            }
            EXPECT_EQ(errorOf("cut.ply", text.substr(0, complete)), "");
        }
    }
}

}  // namespace
}  // namespace iwalk
