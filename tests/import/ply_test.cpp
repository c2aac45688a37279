#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/import/import_fixture.hpp"
#include "tests/import/ply_writer.hpp"

namespace iwalk {
namespace {

const std::vector<std::string> kFormats = {"ascii", "binary_little_endian", "binary_big_endian"};

class PlyTest : public ImportTest {
  protected:
    // Imports the cube as written in this flavour and compares it with what it must give.
    void expectCube(const PlyFlavor& flavor) {
        SCOPED_TRACE(flavor.format + " " + flavor.coordinate + " list " + flavor.count + " " + flavor.index +
                     " color " + flavor.color);
        const TestMesh mesh = testCube();
        const auto imported = importText("model.ply", writePly(mesh, flavor));
        ASSERT_TRUE(imported.ok()) << imported.error().message;
        const bool colors = !flavor.color.empty();
        EXPECT_EQ(imported->triangles, fanned(mesh, colors, flavor.normals));
        EXPECT_EQ(imported->counts.triangles, imported->triangles.size());
        EXPECT_EQ(imported->counts.droppedNonFinite, 0u);
        EXPECT_EQ(imported->vertices.size(), 8u);
        EXPECT_EQ(imported->summary.vertices, 8u);
        EXPECT_EQ(imported->summary.bounds, (ModelBox{glm::dvec3(1, 2, 3), glm::dvec3(20, 30, 127)}));
        EXPECT_EQ(imported->summary.colors, colors);
        EXPECT_EQ(imported->summary.normals, flavor.normals);
        if (flavor.format != "ascii") {
            EXPECT_GE(imported->summary.triangleBound, imported->triangles.size());
        }
    }

    // A binary file of triangles 0 1 2, 3 4 5 ... with the given positions.
    template <class T>
    std::string soup(const std::string& type, const std::vector<std::array<T, 3>>& positions) {
        TestMesh mesh;
        for (const auto& p : positions) mesh.vertices.push_back({glm::dvec3(p[0], p[1], p[2]), 0, {}});
        for (unsigned i = 0; i + 2 < positions.size(); i += 3) mesh.polygons.push_back({i, i + 1, i + 2});
        return writePly(mesh, {.coordinate = type});
    }
};

TEST_F(PlyTest, everyCoordinateType) {
    for (const std::string& format : kFormats) {
        for (const char* type : {"char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16",
                                 "int", "int32", "uint", "uint32", "float", "float32", "double", "float64"}) {
            expectCube({.format = format, .coordinate = type});
        }
    }
}

TEST_F(PlyTest, everyListType) {
    for (const std::string& format : kFormats) {
        for (const char* type : {"char", "uchar", "short", "ushort", "int", "uint", "int8", "uint8", "int16",
                                 "uint16", "int32", "uint32"}) {
            expectCube({.format = format, .count = type});
            expectCube({.format = format, .index = type});
        }
    }
}

TEST_F(PlyTest, attributesInEveryForm) {
    for (const std::string& format : kFormats) {
        for (const char* color : {"uchar", "ushort", "float", "double", "int"}) {
            for (const bool reversed : {false, true}) {
                expectCube({.format = format, .color = color, .normals = true, .reversed = reversed});
                expectCube({.format = format, .color = color, .alpha = true, .reversed = reversed});
            }
        }
        expectCube({.format = format, .color = "uchar", .colorPrefix = "diffuse_"});
        expectCube({.format = format, .normals = true});
    }
}

TEST_F(PlyTest, unknownPropertiesAndElementsAndOtherOrders) {
    for (const std::string& format : kFormats) {
        for (const bool reversed : {false, true}) {
            for (const bool facesFirst : {false, true}) {
                PlyFlavor flavor{.format = format, .color = "uchar", .normals = true};
                flavor.reversed = reversed, flavor.facesFirst = facesFirst;
                expectCube(flavor);
                flavor.extras = true;
                expectCube(flavor);
                flavor.vertexLists = true;
                expectCube(flavor);
                flavor.indexName = "vertex_index";
                expectCube(flavor);
            }
        }
    }
}

TEST_F(PlyTest, everyLineEnd) {
    for (const std::string& format : kFormats) {
        for (const char* end : {"\n", "\r\n", "\r"}) expectCube({.format = format, .lineEnd = end});
    }
}

TEST_F(PlyTest, polygonsAreFannedAndLinesLeftOut) {
    TestMesh mesh = testCube();
    mesh.vertices.resize(300, mesh.vertices[1]);
    std::vector<unsigned> large(300);
    for (unsigned i = 0; i < 300; ++i) large[i] = i;
    mesh.polygons = {{}, {1}, {1, 2}, large, {5, 6, 7}};
    const auto imported = importText("model.ply", writePly(mesh, {.count = "ushort"}));
    ASSERT_TRUE(imported.ok()) << imported.error().message;
    EXPECT_EQ(imported->triangles.size(), 299u);
    EXPECT_EQ(imported->triangles, fanned(mesh, false, false));
}

TEST_F(PlyTest, dropsAndCountsTrianglesWithoutAFinitePosition) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const auto imported = importText("model.ply", soup<float>("float", {{0, 0, 0},
                                                                        {1, 0, 0},
                                                                        {0, 1, 0},  //
                                                                        {nan, 0, 0},
                                                                        {1, 0, 0},
                                                                        {0, 1, 0},  //
                                                                        {9, 0, 0},
                                                                        {1, -inf, 0},
                                                                        {0, 1, inf}}));
    ASSERT_TRUE(imported.ok()) << imported.error().message;
    EXPECT_EQ(imported->counts.triangles, 1u);
    EXPECT_EQ(imported->counts.droppedNonFinite, 2u);
    EXPECT_EQ(imported->summary.vertices, 6u);
    EXPECT_EQ(imported->vertices.size(), 6u);
    EXPECT_EQ(imported->summary.bounds, (ModelBox{glm::dvec3(0), glm::dvec3(9, 1, 0)}));
}

TEST_F(PlyTest, textThatIsNoNumberOrTooLargeForFloatIsNotFinite) {
    const std::string header =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
    const auto imported =
        importText("model.ply", header + "0 0 0\n1 -1.#IND 0\n1e39 1 1\n-nan 0 inf\n3 0 1 2\n3 0 0 0\n");
    ASSERT_TRUE(imported.ok()) << imported.error().message;
    EXPECT_EQ(imported->summary.vertices, 1u);
    EXPECT_EQ(imported->counts.triangles, 1u);
    EXPECT_EQ(imported->counts.droppedNonFinite, 1u);
}

TEST_F(PlyTest, badNormalsBecomeTheFacesAndOthersUnitLength) {
    TestMesh mesh = testCube();
    mesh.vertices = {{glm::dvec3(0), 0, glm::vec3(0)},
                     {glm::dvec3(2, 0, 0), 0, glm::vec3(std::nanf(""), 0, 1)},
                     {glm::dvec3(0, 2, 0), 0, glm::vec3(std::ldexp(3.0f, 100), 0, std::ldexp(4.0f, 100))}};
    mesh.polygons = {{0, 1, 2}, {0, 0, 0}};
    const auto imported = importText("model.ply", writePly(mesh, {.normals = true}));
    ASSERT_TRUE(imported.ok()) << imported.error().message;
    const Triangle& t = imported->triangles[0];
    EXPECT_EQ(t[0].normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(t[1].normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(t[2].normal, glm::vec3(0.6f, 0, 0.8f));
    EXPECT_EQ(imported->triangles[1][0].normal, glm::vec3(0, 0, 1))
        << "no area: any direction, but unit length";
}

TEST_F(PlyTest, doublesKeepAllTheirBits) {
    const double x = 1e6 + 1e-7;
    for (const std::string& format : kFormats) {
        TestMesh mesh = testCube();
        mesh.vertices[1].position = glm::dvec3(x, -1.0 / 3, 5e-324);
        const auto imported =
            importText("model.ply", writePly(mesh, {.format = format, .coordinate = "double"}));
        ASSERT_TRUE(imported.ok()) << imported.error().message;
        EXPECT_EQ(imported->triangles, fanned(mesh, false, false));
    }
}

TEST_F(PlyTest, precisionIsTheSpacingAtTheLargestCoordinate) {
    const auto precision = [&](const std::string& contents) {
        const auto imported = importText("model.ply", contents);
        return imported.ok() ? imported->summary.precision : -1;
    };
    EXPECT_EQ(precision(soup<double>("float", {{0, 0, -1023}, {0, 1, 0}, {1, 0, 0}})), std::ldexp(1, 9 - 23));
    EXPECT_EQ(precision(soup<double>("double", {{0, 0, -1024}, {0, 1, 0}, {1, 0, 0}})),
              std::ldexp(1, 10 - 52));
    EXPECT_EQ(precision(soup<double>("short", {{0, 0, 20}, {0, 1, 0}, {1, 0, 0}})), 1.0);
    EXPECT_EQ(precision(soup<double>("float", {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}})), std::ldexp(1, -23));
    EXPECT_GT(precision(soup<double>("double", {{5e-324, 0, 0}, {0, 0, 0}, {0, 0, 0}})), 0.0);
}

TEST_F(PlyTest, spilledVerticesGiveTheSameTriangles) {
    TestMesh mesh;
    constexpr unsigned kCount = 60000;
    for (unsigned i = 0; i < kCount; ++i) {
        mesh.vertices.push_back({glm::dvec3(i, i * 0.5, i % 7), 0xff000000u | i, glm::vec3(0, 1, 0)});
    }
    // Near neighbours first, then vertices from all over the place.
    for (unsigned i = 0; i + 2 < kCount; i += 2) mesh.polygons.push_back({i, i + 1, i + 2});
    for (unsigned i = 0; i < 5000; ++i) {
        mesh.polygons.push_back({i * 7919 % kCount, i * 104729 % kCount, (i * i) % kCount});
    }
    const PlyFlavor flavor{.coordinate = "double", .color = "uchar", .normals = true};
    directory_.write("model.ply", writePly(mesh, flavor));
    const auto tiny = import("model.ply", 0);
    ASSERT_TRUE(tiny.ok()) << tiny.error().message;
    EXPECT_TRUE(tiny->triangles == fanned(mesh, true, true));
    const auto large = import("model.ply");
    ASSERT_TRUE(large.ok()) << large.error().message;
    EXPECT_TRUE(large->triangles == tiny->triangles);
    EXPECT_EQ(directory_.list(), std::vector<std::string>{"model.ply"});
}

TEST_F(PlyTest, spillFileHasNoNameWhileItIsInUse) {
    TestMesh mesh = testCube();
    mesh.vertices.resize(100000);
    directory_.write("model.ply", writePly(mesh, {}));
    const auto importer = openImporter(directory_.path("model.ply"), {0, directory_.path("")});
    ASSERT_TRUE(importer.ok());
    ASSERT_TRUE((*importer)->scan({}, {}).ok());
    EXPECT_EQ(directory_.list(), std::vector<std::string>{"model.ply"});
}

TEST_F(PlyTest, spillThatCannotBeMadeIsAnError) {
    TestMesh mesh = testCube();
    mesh.vertices.resize(100000);
    directory_.write("model.ply", writePly(mesh, {}));
    const auto importer = openImporter(directory_.path("model.ply"), {0, directory_.path("nowhere")});
    ASSERT_TRUE(importer.ok());
    const auto summary = (*importer)->scan({}, {});
    ASSERT_FALSE(summary.ok());
    EXPECT_THAT(summary.error().message,
                testing::StartsWith(directory_.path("nowhere") + ": cannot make a spill file"));
}

TEST_F(PlyTest, progressRisesToOneInBothPasses) {
    TestMesh mesh = testCube();
    mesh.vertices.resize(900000);
    directory_.write("model.ply", writePly(mesh, {}));
    const auto imported = import("model.ply");
    ASSERT_TRUE(imported.ok()) << imported.error().message;
    EXPECT_GE(imported->progress.size(), 4u);
    EXPECT_GE(std::ranges::count(imported->progress, 1.0), 2);
    const auto passEnd = std::ranges::find(imported->progress, 1.0);
    EXPECT_TRUE(std::is_sorted(imported->progress.begin(), passEnd));
    EXPECT_EQ(imported->progress.back(), 1.0);
}

TEST_F(PlyTest, theSinksErrorEndsTheReading) {
    directory_.write("model.ply", writePly(testCube(), {}));
    const auto importer = openImporter(directory_.path("model.ply"), {0, directory_.path("")});
    ASSERT_TRUE(importer.ok());
    ASSERT_TRUE((*importer)->scan({}, {}).ok());
    const auto counts =
        (*importer)->triangles([](auto) -> Result<void> { return fail("the disk is full"); }, {});
    ASSERT_FALSE(counts.ok());
    EXPECT_EQ(counts.error().message, "the disk is full");
}

TEST_F(PlyTest, isKnownByItsFirstBytesWhateverItsName) {
    const auto imported = importText("model.dat", writePly(testCube(), {}));
    EXPECT_TRUE(imported.ok());
}

TEST_F(PlyTest, withoutFacesThereAreNoTriangles) {
    const auto imported = importText("model.ply",
                                     "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int "
                                     "y\nproperty int z\nend_header\n1 2 3\n");
    ASSERT_TRUE(imported.ok()) << imported.error().message;
    EXPECT_EQ(imported->counts.triangles, 0u);
    EXPECT_EQ(imported->summary.vertices, 1u);
}

TEST_F(PlyTest, anUnknownLineBeforeTheElementsIsPassedOver) {
    std::string text = writePly(testCube(), {});
    text.insert(text.find("comment"), "Created by Some Program\n");
    const auto imported = importText("model.ply", text);
    ASSERT_TRUE(imported.ok()) << imported.error().message;
    EXPECT_EQ(imported->triangles, fanned(testCube(), false, false));
}

}  // namespace
}  // namespace iwalk
