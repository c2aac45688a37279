// Bytes of version 1, fixed: what docs/format.md says and what programs write must not drift apart.
#include <gtest/gtest.h>

#include "common/dataset/morph.hpp"
#include "common/file.hpp"
#include "tests/common/dataset_fixture.hpp"

namespace iwalk {
namespace {

// Groups of 8 bytes, four to a line.
std::string hex(std::span<const std::byte> bytes) {
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (i > 0 && i % 8 == 0) text += i % 32 == 0 ? '\n' : ' ';
        text += fmt::format("{:02x}", static_cast<unsigned>(bytes[i]));
    }
    return text;
}

class GoldenTest : public DatasetTest {
  protected:
    std::string hierarchyBytes(std::size_t place, std::size_t count) const {
        const std::string file = readWholeFile(directory_.path("hierarchy-3.bin"), 99999).value();
        return hex(std::as_bytes(std::span(file)).subspan(place, count));
    }
};

TEST_F(GoldenTest, HierarchyHeader) {
    EXPECT_EQ(hierarchyBytes(0, 72),
              "4957485301000000 0403020109000000 9cffffffffffffff 9cffffffffffffff\n"
              "9cffffffffffffff 0400000009000000 0700000000000000 2138379a35054891\n"
              "41b6350db359fc51");
}

TEST_F(GoldenTest, NodeRecord) {
    EXPECT_EQ(hierarchyBytes(72, 128),
              "a6ffffffffffffff a6ffffffffffffff a6ffffffffffffff 5f00000000000000\n"
              "5f00000000000000 5f00000000000000 b0ffffffffffffff b0ffffffffffffff\n"
              "b0ffffffffffffff 4600000000000000 4600000000000000 4600000000000000\n"
              "0100000000000000 0383000000000000 0000000000000000 0000000000000000");
    EXPECT_EQ(hierarchyBytes(72 + 3 * 128, 128),
              "1400000000000000 1400000000000000 1400000000000000 5a00000000000000\n"
              "5a00000000000000 5a00000000000000 1400000000000000 1400000000000000\n"
              "1400000000000000 5a00000000000000 5a00000000000000 5a00000000000000\n"
              "0000000006000000 0300010000010203 0405060708090a0b 0c0d0e0f10111213");
}

TEST_F(GoldenTest, LevelRecord) {
    EXPECT_EQ(hierarchyBytes(72 + 4 * 128 + 6 * 32, 32),
              "0100000001000000 0400000006000000 0000004002000200 0100000000000000");
}

TEST_F(GoldenTest, PageRecord) {
    EXPECT_EQ(hierarchyBytes(72 + 4 * 128 + 9 * 32 + 2 * 48, 48),
              "8403000000000000 7400000000000000 2c0100006a000000 0700000012000000\n"
              "0100000000000100 0a00000000000000");
}

TEST_F(GoldenTest, Manifest) {
    EXPECT_EQ(readWholeFile(directory_.path(kManifestName), 99999).value(), R"json({
  "format": "iwalk-dataset",
  "version": 1,
  "generation": 3,
  "triangles": 17,
  "vertices": 55,
  "nodes": 4,
  "leaves": 3,
  "pages": 7,
  "leaf_triangles": 16,
  "levels": [
    {
      "error": 7.62939453125e-06,
      "triangles": 4,
      "bytes": 500
    },
    {
      "error": 3.814697265625e-06,
      "triangles": 11,
      "bytes": 516
    },
    {
      "error": 1.9073486328125e-06,
      "triangles": 16,
      "bytes": 406
    }
  ],
  "full": {
    "error": 0.0,
    "triangles": 17,
    "bytes": 1658
  },
  "attributes": {
    "colors": true,
    "normals": false
  },
  "step_exponent": -20,
  "bounds": {
    "min": [
      -1.5,
      -0.1,
      0.0
    ],
    "max": [
      1.0,
      2.0,
      1e+300
    ]
  },
  "hierarchy": {
    "name": "hierarchy-3.bin",
    "bytes": 1208
  },
  "page_files": [
    {
      "name": "pages-3.bin",
      "bytes": 2400
    },
    {
      "name": "morphs-3.bin",
      "bytes": 696
    }
  ],
  "provenance": [
    {
      "input": "rack \"1\".ply",
      "triangles": 17,
      "dropped_non_finite": 1,
      "dropped_degenerate": 2
    }
  ]
}
)json");
}

// Two triangles in two ranges, with normals; the second range's box is larger than its triangle.
TEST(GoldenPageTest, PageAndMorphBlock) {
    PageGeometry page;
    page.origin = LatticePoint(-5, std::int64_t{1} << 40, 17);
    page.attributes = kPageNormals;
    page.vertices = {{{0, 0, 1}, 0, 0x00010002},
                     {{9, 0, 0}, 0, 0x00030004},
                     {{0, 7, 2}, 0, 0x00050006},
                     {{0x1fffff, 8, 3}, 0, 0x00070008}};
    page.indices = {0, 1, 2, 2, 1, 3};
    page.ranges = {{0, 3, 0b1000, {0, 0, 0}, {9, 7, 2}}, {3, 3, 0b1001'111, {0, 0, 0}, {0x200000, 8, 4}}};
    PageRecord record{};
    EXPECT_EQ(hex(encodePage(page, record)),
              "4957504701000000 0400000004000000 0600000002000000 fbffffffffffffff\n"
              "0000000000010000 1100000000000000 8800000059000000 4372f02f1148099d\n"
              "e100000044000000 0531d4ab155041c3 0000000000000000 0000000000000000\n"
              "2501000033000000 8f33a02b1330d2b8 5801000013000000 1cf307cb62991b53\n"
              "78cf702c9507940e a000000000013000 00008e0000000000 0000000000000000\n"
              "0000013000000011 0001300000004000 0120000000000000 0130000000040000\n"
              "0001000000080000 0000000000000000 0000000000090000 0007000000020000\n"
              "00a0013d00000012 110101000000010f 0000003f7e010200 000000013f000000\n"
              "0710080000000000 0000000000000000 0000000000000000 0000000000000000\n"
              "0000040000a0013f 0000000404040001 3f00000004040400 0000000000000000\n"
              "0000000000000000 0000000000000000 0000000002000100 e1f0100076875667\n"
              "78a9866589689801 690000");

    std::vector<LatticePoint> positions;
    for (const PageVertex& v : page.vertices) {
        positions.push_back(page.origin + LatticePoint(v.offset[0], v.offset[1], v.offset[2]));
    }
    // Stays, goes to another vertex, to an extra position, and to another one.
    const LatticePoint extra = page.origin + LatticePoint(-1, 7, 2),
                       other = extra + LatticePoint(0x200000, 0, 0);
    const std::vector<LatticePoint> targets{positions[0], positions[0], extra, other};
    EXPECT_EQ(hex(encodeMorph({page.origin, positions, targets, page.ranges, page.indices}, record)),
              "49574d4f01000000 0800000004000000 0200000002000000 faffffffffffffff\n"
              "0000000000010000 1200000000000000 6800000047000000 9062ad771dd0dd96\n"
              "af0000002a000000 f6d17b7bf3cc6799 d900000032000000 d36506882dcb4f91\n"
              "3ee780feb487047b a000000000000000 0000000000013000 00001f0000000120\n"
              "0000000000000130 0000000600000000 0000000000000001 0000000000000002\n"
              "0000001100000000 00000000000000a0 010e000000080000 0000000000000000\n"
              "0000000000000000 0000000000000000 0000000000000000 00a0000001300000\n"
              "0040000000000000 0000000000000000 0000000000000000 0000000000000000\n"
              "0000000700000001 000000");
    EXPECT_EQ(record.flags, kPageNormals | kMorphWide);
}

}  // namespace
}  // namespace iwalk
