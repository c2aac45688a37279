#include "common/dataset/page.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/geometric.hpp>
#include <random>

#include "tests/common/page_sample.hpp"

namespace iwalk {
namespace {

PageRecord makeRecord(std::uint32_t flags) {
    PageRecord record{};
    record.bytes = 1000;
    record.vertexCount = 3, record.indexCount = 6, record.rangeCount = 1;
    record.flags = flags;
    return record;
}

// A triangle as a cyclic order starting at its smallest corner: the index codec may rotate triangles.
std::array<std::uint32_t, 3> canonical(std::array<std::uint32_t, 3> t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
}

void expectRoundTrip(const PageGeometry& page, std::uint32_t flags) {
    PageRecord record{};
    const std::vector<std::byte> bytes = encodePage(page, record);
    EXPECT_EQ(record.flags, flags);
    EXPECT_EQ(record.bytes, bytes.size());
    const PageLayout layout = pageLayout(record);
    EXPECT_EQ(layout.bytes % 256, 0u);
    std::vector<std::byte> out(layout.bytes);
    const auto table = decodePage(bytes, record, out);
    ASSERT_TRUE(table.ok()) << table.error().message;
    EXPECT_EQ(table->origin, page.origin);
    ASSERT_EQ(table->ranges.size(), page.ranges.size());
    EXPECT_EQ(std::memcmp(table->ranges.data(), page.ranges.data(), page.ranges.size() * sizeof(Range)), 0);
    for (std::uint32_t v = 0; v < page.vertices.size(); ++v) {
        PageVertex vertex{};
        const glm::u32vec3 offset = pageOffset(out, record, v);
        for (std::size_t axis = 0; axis < 3; ++axis) vertex.offset[axis] = offset[axis];
        if ((flags & kPageColors) != 0) std::memcpy(&vertex.color, out.data() + layout.colors + 4 * v, 4);
        if ((flags & kPageNormals) != 0) std::memcpy(&vertex.normal, out.data() + layout.normals + 4 * v, 4);
        EXPECT_TRUE(vertex == page.vertices[v]) << "vertex " << v;
    }
    std::vector<std::uint16_t> indices(record.indexCount);
    std::memcpy(indices.data(), out.data() + layout.indices, 2 * indices.size());
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        EXPECT_EQ(canonical({indices[i], indices[i + 1], indices[i + 2]}),
                  canonical({page.indices[i], page.indices[i + 1], page.indices[i + 2]}));
    }
}

TEST(PageTest, RoundTripsNarrow) {
    expectRoundTrip(makePage(1000, 21, 0), 0);
}
TEST(PageTest, RoundTripsWide) {
    expectRoundTrip(makePage(1000, 22, 0), kPageWide);
}
TEST(PageTest, RoundTripsWidest) {
    expectRoundTrip(makePage(1000, 32, 0), kPageWide);
}
TEST(PageTest, RoundTripsAttributes) {
    expectRoundTrip(makePage(333, 10, kPageColors), kPageColors);
    expectRoundTrip(makePage(333, 10, kPageNormals), kPageNormals);
    expectRoundTrip(makePage(333, 32, kPageColors | kPageNormals), kPageWide | kPageColors | kPageNormals);
}
TEST(PageTest, RoundTripsTheSmallestAndTheLargest) {
    PageGeometry one = makePage(2, 3, 0);
    expectRoundTrip(one, 0);
    expectRoundTrip(makePage(kMaxPageVertices - 2, 21, kPageColors), kPageColors);
}

TEST(PageTest, LayoutIsAlignedAndInOrder) {
    const PageRecord record = makeRecord(kPageWide | kPageColors | kPageNormals);
    const PageLayout layout = pageLayout(record);
    EXPECT_EQ(layout.positions, 0u);
    EXPECT_EQ(layout.positionStride, 12u);
    EXPECT_EQ(layout.colors, 40u);
    EXPECT_EQ(layout.normals, 56u);
    EXPECT_EQ(layout.indices, 72u);
    EXPECT_EQ(layout.bytes, 256u);
}

TEST(PageTest, PathsNameCells) {
    EXPECT_TRUE(isPath(kRootPath));
    EXPECT_TRUE(isPath(0x7fffffff));
    EXPECT_EQ(pathLevels(kRootPath), 0u);
    EXPECT_EQ(pathLevels(0b1'101'011), 2u);
    EXPECT_EQ(pathLevels(0x7fffffff), kMaxPathLevels);
    EXPECT_TRUE(pathContains(kRootPath, 0x7fffffff));
    EXPECT_TRUE(pathContains(0b1'101, 0b1'101'011));
    EXPECT_TRUE(pathContains(0b1'101, 0b1'101));
    EXPECT_FALSE(pathContains(0b1'101'011, 0b1'101));
    EXPECT_FALSE(pathContains(0b1'100, 0b1'101'011));
}

TEST(PageTest, ImpossibleRecordsAreRefused) {
    const PageRecord good = makeRecord(0);
    EXPECT_TRUE(checkPageRecord(good).ok());
    const auto bad = [&](auto change) {
        PageRecord record = good;
        change(record);
        return !checkPageRecord(record).ok();
    };
    EXPECT_TRUE(bad([](PageRecord& r) { r.vertexCount = 65536; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.vertexCount = 0; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.indexCount = 7; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.indexCount = 0xffffffff; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.rangeCount = 3; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.rangeCount = 0; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.flags = 16; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.flags = kMorphWide; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.morphOffset = 1; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.morphFile = 1; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.morphBytes = 103; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.morphBytes = kMaxPageBytes + 1; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.reserved = 1; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.bytes = 100; }));
    EXPECT_TRUE(bad([](PageRecord& r) { r.bytes = kMaxPageBytes + 1; }));
}

TEST(PageTest, NormalsAreCloseEverywhere) {
    std::mt19937 random(3);
    std::normal_distribution<float> gauss;
    double worst = 0;
    const auto measure = [&](const glm::vec3& direction) {
        const glm::vec3 unit = glm::normalize(direction);
        const glm::dvec3 back(unpackNormal(packNormal(unit)));
        const glm::dvec3 exact = glm::normalize(glm::dvec3(unit));
        worst = std::max(worst, glm::length(glm::cross(back, exact)) + (glm::dot(back, exact) < 0 ? 2 : 0));
    };
    for (int i = 0; i < 300'000; ++i) measure(glm::vec3(gauss(random), gauss(random), gauss(random)));
    for (int code = 0; code < 27; ++code) {
        const glm::vec3 axis(float(code % 3 - 1), float(code / 3 % 3 - 1), float(code / 9 - 1));
        if (code != 13) measure(axis);
    }
    EXPECT_LT(worst * 180 / 3.14159265358979, 0.005);
}

}  // namespace
}  // namespace iwalk
