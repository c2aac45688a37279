// Files of all kinds: what a build makes of them, and says of bad ones, does not depend on threads.
#include <gmock/gmock.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/vec2.hpp>
#include <iterator>
#include <limits>

#include "common/file.hpp"
#include "preprocess/build/build.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/import/ply_writer.hpp"
#include "tests/preprocess/soup.hpp"

namespace iwalk {
namespace {

constexpr unsigned kEdge = 150;  // squares; triangles of more batches than are under way at once

// Hills, with what is dropped, split and cut among their triangles.
TestMesh makeHills() {
    TestMesh mesh;
    const auto at = [](unsigned column, unsigned row) { return row * (kEdge + 1) + column; };
    const auto add = [&](double x, double y, double z) {
        mesh.vertices.push_back({{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}});
    };
    for (unsigned row = 0; row <= kEdge; ++row) {
        for (unsigned column = 0; column <= kEdge; ++column)
            add(0.1 * column, 0.1 * row, std::sin(0.13 * column) * std::cos(0.09 * row));
    }
    for (unsigned row = 0; row < kEdge; ++row) {
        for (unsigned column = 0; column < kEdge; ++column) {
            mesh.polygons.push_back({at(column, row), at(column + 1, row), at(column + 1, row + 1)});
            mesh.polygons.push_back({at(column, row), at(column + 1, row + 1), at(column, row + 1)});
        }
    }
    const auto far = static_cast<unsigned>(mesh.vertices.size());
    add(3e6, 2e6, -1e6);
    add(std::numeric_limits<double>::quiet_NaN(), 0, 0);
    mesh.polygons[7000] = {0, 40, far};
    mesh.polygons[12'000] = {8000, 8001, 8000};
    mesh.polygons[17'000] = {9000, far + 1, 9001};
    return mesh;
}

std::string obj(const TestMesh& mesh) {
    std::string text;
    for (const Corner& v : mesh.vertices)
        text += fmt::format("v {} {} {}\n", v.position.x, v.position.y, v.position.z);
    for (const auto& p : mesh.polygons) text += fmt::format("f {} {} {}\n", p[0] + 1, p[1] + 1, p[2] + 1);
    return text;
}

std::string vrml(const TestMesh& mesh) {
    std::string text = "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { coord Coordinate { point [\n";
    for (const Corner& v : mesh.vertices)
        text += fmt::format("{} {} {},\n", v.position.x, v.position.y, v.position.z);
    text += "] }\ncoordIndex [\n";
    for (const auto& p : mesh.polygons) text += fmt::format("{} {} {} -1\n", p[0], p[1], p[2]);
    return text + "] } }\n";
}

std::string textStl(const TestMesh& mesh) {
    std::string text = "solid a\n";
    for (const Triangle& triangle : fanned(mesh, false, false)) {
        text += "facet normal 0 0 1\nouter loop\n";
        for (const Corner& c : triangle)
            text += fmt::format("vertex {} {} {}\n", c.position.x, c.position.y, c.position.z);
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid a\n";
}

std::string binaryStl(const TestMesh& mesh) {
    std::string bytes(80, ' ');
    const auto count = static_cast<std::uint32_t>(mesh.polygons.size());
    bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    for (const Triangle& triangle : fanned(mesh, false, false)) {
        bytes.append(12, '\0');
        for (const Corner& c : triangle) {
            const glm::vec3 position(c.position);
            bytes.append(reinterpret_cast<const char*>(&position), sizeof position);
        }
        bytes.append(2, '\0');
    }
    return bytes;
}

// When it comes to light that a vertex is not there: while vertices are read, or triangles.
enum class Indices { none, scanned, read };

// A kind of file.
struct Kind {
    std::string name, extension;
    std::string (*write)(const TestMesh&);
    Indices indices;
    std::string cutShort;  // what is said of one that is; "" when nobody can know
};
std::ostream& operator<<(std::ostream& out, const Kind& kind) {
    return out << kind.name;
}

class ReadingTest : public testing::TestWithParam<Kind> {
  protected:
    ReadingTest() { spdlog::set_level(spdlog::level::off); }
    ~ReadingTest() override { spdlog::set_level(spdlog::level::info); }

    std::string path(const std::string& name) const { return directory_.path(name); }

    Result<Manifest> build(unsigned threads) {
        NoProgress progress;
        BuildOptions options;
        options.inputs = {path(file_)};
        options.output = path(fmt::format("{}-threads", threads));
        options.leafTriangles = 1000;
        options.stepExponent = -20;
        options.threads = threads;
        return buildDataset(options, progress);
    }
    std::string bytesOf(unsigned threads, const char* file) const {
        return readWholeFile(path(fmt::format("{}-threads/{}", threads, file)), 1u << 30).value();
    }

    // The error, of one line and the same for all threads, without the file's path.
    std::string errorOf(const std::string& contents) {
        directory_.write(file_, contents);
        std::string first;
        for (const unsigned threads : {1u, 2u, 4u}) {
            const Result<Manifest> built = build(threads);
            EXPECT_FALSE(built.ok()) << threads << " threads";
            if (built) return "";
            const std::string& message = built.error().message;
            if (threads == 1) first = message;
            EXPECT_EQ(message, first) << threads << " threads";
        }
        EXPECT_EQ(directory_.list(), std::vector<std::string>{file_});
        EXPECT_EQ(first.find('\n'), std::string::npos) << first;
        EXPECT_TRUE(first.starts_with(path(file_) + ": ")) << first;
        return first.substr(std::min(first.size(), path(file_).size() + 2));
    }

    TempDirectory directory_;
    std::string file_ = "model" + GetParam().extension;
    TestMesh mesh_ = makeHills();
};

TEST_P(ReadingTest, BytesDoNotDependOnThreads) {
    directory_.write(file_, GetParam().write(mesh_));
    for (const unsigned threads : {1u, 2u, 4u}) {
        const Result<Manifest> built = build(threads);
        ASSERT_TRUE(built.ok()) << built.error().message;
        const Provenance& input = built->provenance.at(0);
        EXPECT_EQ(input.triangles, built->triangles);
        EXPECT_GT(input.triangles, mesh_.polygons.size());
        EXPECT_EQ(input.droppedNonFinite, 1u);
        EXPECT_EQ(input.droppedDegenerate, 1u);
        EXPECT_EQ(input.split, 1u);
        EXPECT_EQ(input.cut, 1u);
        for (const char* file : {"dataset.json", "hierarchy-1.bin", "pages-1.bin"})
            EXPECT_TRUE(bytesOf(threads, file) == bytesOf(1, file)) << file << ", " << threads << " threads";
    }
}

class CutShortTest : public ReadingTest {};
TEST_P(CutShortTest, SaysSo) {
    const std::string contents = GetParam().write(mesh_);
    EXPECT_THAT(errorOf(contents.substr(0, contents.size() * 9 / 10)),
                testing::HasSubstr(GetParam().cutShort));
}

class IndexedReadingTest : public ReadingTest {};
// Batches of good triangles are on their way when it is read.
TEST_P(IndexedReadingTest, BadIndices) {
    mesh_.polygons[30'000][1] = 7'000'000;
    EXPECT_THAT(errorOf(GetParam().write(mesh_)), testing::ContainsRegex("[iI]ndex 700000[01].* 22803 "));
}

// A triangle that does not fit comes to light while others behind it are read, or are found to be bad.
TEST_P(IndexedReadingTest, TheFirstErrorCounts) {
    const auto far = static_cast<unsigned>(mesh_.vertices.size());
    for (const glm::dvec2& side : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0, 1)})
        mesh_.vertices.push_back({glm::dvec3(1e13, side)});
    mesh_.polygons[20'000] = {far, far + 1, far + 2};
    if (GetParam().indices == Indices::read) mesh_.polygons[28'000][1] = 7'000'000;
    // Of those before it one is dropped, and one in several pieces.
    EXPECT_THAT(errorOf(GetParam().write(mesh_)),
                testing::ContainsRegex("^triangle 20[0-9]{3} at \\(1e\\+13, .*too far out"));
}

const std::vector<Kind> kKinds{
    {"AsciiPly", ".ply",
     [](const TestMesh& m) { return writePly(m, {.format = "ascii", .coordinate = "double"}); },
     Indices::read, "cut short"},
    {"BinaryPly", ".ply", [](const TestMesh& m) { return writePly(m, {.coordinate = "double"}); },
     Indices::read, "cut short"},
    {"BigEndianPly", ".ply",
     [](const TestMesh& m) {
         return writePly(m, {.format = "binary_big_endian", .coordinate = "double", .extras = true});
     },
     Indices::read, "file"},
    {"Obj", ".obj", obj, Indices::read, ""},
    {"BinaryStl", ".stl", binaryStl, Indices::none, "cut short"},
    {"AsciiStl", ".stl", textStl, Indices::none, "line "},
    {"Vrml", ".wrl", vrml, Indices::scanned, "line "}};

template <class Which>
std::vector<Kind> kindsThat(Which which) {
    std::vector<Kind> kinds;
    std::copy_if(kKinds.begin(), kKinds.end(), std::back_inserter(kinds), which);
    return kinds;
}

const auto nameOf = [](const auto& kind) { return kind.param.name; };
INSTANTIATE_TEST_SUITE_P(Kinds, ReadingTest, testing::ValuesIn(kKinds), nameOf);
INSTANTIATE_TEST_SUITE_P(Kinds, CutShortTest,
                         testing::ValuesIn(kindsThat([](const Kind& k) { return !k.cutShort.empty(); })),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Kinds, IndexedReadingTest, testing::ValuesIn(kindsThat([](const Kind& k) {
                             return k.indices != Indices::none;
                         })),
                         nameOf);

}  // namespace
}  // namespace iwalk
