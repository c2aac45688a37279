#include <gmock/gmock.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/import/import_fixture.hpp"

namespace iwalk {
namespace {

using testing::HasSubstr;
using Facet = std::array<float, 9>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const std::vector<Facet> kFacets{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 2.5f, 1, 0, 0, -33554432, 1, 0.125f}};

// `count` as the header says it.
std::string binaryStl(const std::vector<Facet>& facets, std::uint32_t count,
                      const std::string& header = "made by a test") {
    std::string out = header;
    out.resize(80, ' ');
    out.append(reinterpret_cast<const char*>(&count), 4);
    for (const Facet& facet : facets) {
        out.append(12, '\0');
        out.append(reinterpret_cast<const char*>(facet.data()), sizeof facet);
        out.append(2, '\x7f');
    }
    return out;
}

std::string textStl(const std::vector<Facet>& facets) {
    std::string out = "solid a name\n";
    for (const Facet& f : facets) {
        out += "  facet normal 0 0 1\n    outer loop\n";
        for (std::size_t i = 0; i < 9; i += 3)
            out += fmt::format("      vertex {} {} {}\n", f[i], f[i + 1], f[i + 2]);
        out += "    endloop\n  endfacet\n";
    }
    return out + "endsolid a name\n";
}

class StlTest : public ImportTest {
  protected:
    StlTest() { spdlog::set_level(spdlog::level::off); }
    ~StlTest() override { spdlog::set_level(spdlog::level::info); }

    static void expectFacets(const Result<Imported>& result, const std::vector<Facet>& facets) {
        ASSERT_TRUE(result.ok()) << result.error().message;
        ASSERT_EQ(result->triangles.size(), facets.size());
        for (std::size_t t = 0; t < facets.size(); ++t) {
            for (std::size_t i = 0; i < 9; ++i)
                EXPECT_EQ(result->triangles[t][i / 3].position[i % 3], static_cast<double>(facets[t][i]));
        }
        EXPECT_EQ(result->summary.triangleBound, facets.size());
        EXPECT_EQ(result->summary.vertices, 3 * facets.size());
        EXPECT_EQ(result->vertices.size(), 3 * facets.size());
        EXPECT_FALSE(result->summary.colors || result->summary.normals);
    }
};

TEST_F(StlTest, binary) {
    const auto result = importText("a.stl", binaryStl(kFacets, 2));
    expectFacets(result, kFacets);
    EXPECT_EQ(result->summary.bounds.min.x, -33554432);
    EXPECT_EQ(result->summary.precision, 4);  // of floats at 2^25
}

TEST_F(StlTest, binaryOfManyWindows) {
    std::vector<Facet> facets;
    for (int i = 0; i < 12345; ++i) {
        const auto x = static_cast<float>(i);
        facets.push_back({x, 0, 0, x + 1, 0, 0, x, 1, 0});
    }
    expectFacets(importText("a.STL", binaryStl(facets, 12345)), facets);
}

TEST_F(StlTest, binaryThatBeginsLikeText) {
    expectFacets(importText("a.stl", binaryStl(kFacets, 2, "solid but not a text")), kFacets);
    EXPECT_THAT(errorOf("a.stl", binaryStl(kFacets, 3, "solid but not a text")), HasSubstr("cut short"));
}

TEST_F(StlTest, text) {
    expectFacets(importText("a.stl", textStl(kFacets)), kFacets);
    std::string upper = textStl(kFacets);
    for (char& c : upper) c = static_cast<char>(std::toupper(c));
    expectFacets(importText("a.stl", upper), kFacets);
    expectFacets(importText("a.stl", textStl({kFacets[0]}) + textStl({kFacets[1]})), kFacets);
}

TEST_F(StlTest, textFacetsOfFourCornersAreFanned) {
    const std::string quad =
        "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid\n";
    expectFacets(importText("a.stl", quad), {{0, 0, 0, 1, 0, 0, 1, 1, 0}, {0, 0, 0, 1, 1, 0, 0, 1, 0}});
}

TEST_F(StlTest, countsThatWereNeverFilledIn) {
    for (const std::uint32_t count : {0u, 0xffffffffu})
        expectFacets(importText("a.stl", binaryStl(kFacets, count)), kFacets);
}

TEST_F(StlTest, countsThatAreWrong) {
    EXPECT_EQ(errorOf("a.stl", binaryStl(kFacets, 3)),
              "the header (byte 80) says 3 triangles, the file has room for 2: it is cut short");
    EXPECT_THAT(errorOf("a.stl", binaryStl(kFacets, 4'000'000'000)), HasSubstr("cut short"));
    expectFacets(importText("a.stl", binaryStl(kFacets, 1)), {kFacets[0]});
}

TEST_F(StlTest, cutShort) {
    const std::string binary = binaryStl(kFacets, 2), text = textStl(kFacets);
    EXPECT_THAT(errorOf("a.stl", binary.substr(0, 83)), HasSubstr("is no STL"));
    EXPECT_THAT(errorOf("a.stl", binary.substr(0, 84)), HasSubstr("room for 0"));
    EXPECT_THAT(errorOf("a.stl", binary.substr(0, binary.size() - 1)), HasSubstr("room for 1"));
    EXPECT_THAT(errorOf("a.stl", text.substr(0, text.rfind("    endloop"))), HasSubstr("cut short"));
    EXPECT_THAT(errorOf("a.stl", text.substr(0, text.rfind(' ', text.rfind("    endloop") - 1))),
                HasSubstr("line 13: a vertex needs three numbers"));
}

TEST_F(StlTest, badText) {
    EXPECT_EQ(errorOf("a.stl", "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 x 0\n"),
              "line 4: a vertex needs three numbers, not ' 0 x 0'");
    EXPECT_EQ(errorOf("a.stl", "solid\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nendloop\n"),
              "line 5: a facet needs three corners");
    EXPECT_THAT(errorOf("a.stl", "hello"), HasSubstr("is no STL"));
}

TEST_F(StlTest, nothing) {
    EXPECT_EQ(errorOf("a.stl", ""), "is empty");
    expectFacets(importText("a.stl", binaryStl({}, 0)), {});
    expectFacets(importText("a.stl", "solid nothing\nendsolid nothing\n"), {});
}

TEST_F(StlTest, notFinite) {
    std::vector<Facet> facets = kFacets;
    facets[0][4] = kNan;
    for (const std::string& file : {binaryStl(facets, 2), textStl(facets)}) {
        const auto result = importText("a.stl", file);
        ASSERT_TRUE(result.ok()) << result.error().message;
        EXPECT_EQ(result->counts.triangles, 1u);
        EXPECT_EQ(result->counts.droppedNonFinite, 1u);
        EXPECT_EQ(result->summary.vertices, 5u);
    }
}

}  // namespace
}  // namespace iwalk
