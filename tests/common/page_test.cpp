#include "common/dataset/page.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <glm/geometric.hpp>
#include <random>

namespace iwalk {
namespace {

// A strip of triangles in two ranges; offsets below 2^bits.
PageGeometry makePage(std::uint32_t triangles, int bits, std::uint32_t attributes) {
    std::mt19937 random(7);
    PageGeometry page;
    page.origin = LatticePoint(-5, std::int64_t{1} << 40, 17);
    page.attributes = attributes;
    const std::uint32_t mask = static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
    for (std::uint32_t v = 0; v < triangles + 2; ++v) {
        PageVertex vertex{};
        for (std::uint32_t& axis : vertex.offset) axis = static_cast<std::uint32_t>(random()) & mask;
        if ((attributes & kPageColors) != 0) vertex.color = static_cast<std::uint32_t>(random());
        if ((attributes & kPageNormals) != 0) vertex.normal = static_cast<std::uint32_t>(random());
        page.vertices.push_back(vertex);
    }
    page.vertices[0].offset[2] = mask;
    for (std::uint32_t i = 0; i < 3 * triangles; ++i)
        page.indices.push_back(static_cast<std::uint16_t>(i / 3 + i % 3));
    const std::uint32_t half = triangles / 2 * 3;
    page.ranges.push_back({0, half, {1, 2, 3}, {4, 5, 6}});
    page.ranges.push_back({half, 3 * triangles - half, {0, 0, 0}, {mask, mask, mask}});
    return page;
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
    const PageRecord record{0, 0, 1000, 3, 6, 1, kPageWide | kPageColors | kPageNormals};
    const PageLayout layout = pageLayout(record);
    EXPECT_EQ(layout.positions, 0u);
    EXPECT_EQ(layout.positionStride, 12u);
    EXPECT_EQ(layout.colors, 40u);
    EXPECT_EQ(layout.normals, 56u);
    EXPECT_EQ(layout.indices, 72u);
    EXPECT_EQ(layout.bytes, 256u);
}

// The first bytes of version 0, as docs/format.md has them.
TEST(PageTest, GoldenHeader) {
    const PageGeometry page = makePage(2, 3, kPageNormals);
    PageRecord record{};
    const std::vector<std::byte> bytes = encodePage(page, record);
    std::array<std::uint32_t, 6> head{};
    std::memcpy(head.data(), bytes.data(), sizeof(head));
    EXPECT_EQ(head, (std::array<std::uint32_t, 6>{0x47505749, 0, kPageNormals, 4, 6, 2}));
    EXPECT_EQ(std::memcmp(bytes.data(), "IWPG", 4), 0);
    std::array<std::int64_t, 3> origin{};
    std::memcpy(origin.data(), bytes.data() + 24, sizeof(origin));
    EXPECT_EQ(origin, (std::array<std::int64_t, 3>{-5, std::int64_t{1} << 40, 17}));
    std::array<std::uint32_t, 2> ranges{};
    std::memcpy(ranges.data(), bytes.data() + 48, sizeof(ranges));
    EXPECT_EQ(ranges, (std::array<std::uint32_t, 2>{136, 64}));  // the range table: two ranges of 32 bytes
    std::array<std::byte, 16> colors{};
    std::memcpy(colors.data(), bytes.data() + 48 + 2 * 16, sizeof(colors));
    EXPECT_EQ(colors, (std::array<std::byte, 16>{}));  // no colours: blank
}

TEST(PageTest, EveryTruncationIsFound) {
    const PageGeometry page = makePage(20, 21, kPageColors);
    PageRecord record{};
    const std::vector<std::byte> bytes = encodePage(page, record);
    std::vector<std::byte> out(pageLayout(record).bytes);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        PageRecord shorter = record;
        shorter.bytes = static_cast<std::uint32_t>(length);
        EXPECT_FALSE(decodePage(std::span(bytes).first(length), record, out).ok()) << length;
        EXPECT_FALSE(decodePage(std::span(bytes).first(length), shorter, out).ok()) << length;
    }
}

TEST(PageTest, EveryFlippedByteIsFound) {
    const PageGeometry page = makePage(20, 21, kPageColors | kPageNormals);
    PageRecord record{};
    std::vector<std::byte> bytes = encodePage(page, record);
    std::vector<std::byte> out(pageLayout(record).bytes);
    for (std::byte& byte : bytes) {
        byte ^= std::byte{0x10};
        EXPECT_FALSE(decodePage(bytes, record, out).ok()) << &byte - bytes.data();
        byte ^= std::byte{0x10};
    }
    EXPECT_TRUE(decodePage(bytes, record, out).ok());
}

// Checksums that are right do not make the contents right.
TEST(PageTest, WrongContentsUnderRightChecksumsAreFound) {
    const auto decodes = [](const PageGeometry& page) {
        PageRecord record{};
        const std::vector<std::byte> bytes = encodePage(page, record);
        std::vector<std::byte> out(pageLayout(record).bytes);
        return decodePage(bytes, record, out).ok();
    };
    const PageGeometry good = makePage(20, 21, 0);
    ASSERT_TRUE(decodes(good));
    PageGeometry bad = good;
    bad.indices[10] = static_cast<std::uint16_t>(bad.vertices.size());
    EXPECT_FALSE(decodes(bad)) << "index out of range";
    bad = good, bad.ranges[1].firstIndex += 3;
    EXPECT_FALSE(decodes(bad)) << "gap between ranges";
    bad = good, bad.ranges[1].indexCount -= 3;
    EXPECT_FALSE(decodes(bad)) << "ranges end early";
    bad = good, bad.ranges[1].indexCount += 3;
    EXPECT_FALSE(decodes(bad)) << "ranges end late";
    bad = good, bad.ranges[0].indexCount = 0;
    EXPECT_FALSE(decodes(bad)) << "empty range";
    bad = good, bad.ranges[0].boxMin[1] = 6;
    EXPECT_FALSE(decodes(bad)) << "box inside out";
    bad = good, bad.origin.x = kLatticeLimit + 1;
    EXPECT_FALSE(decodes(bad)) << "origin out of bounds";
}

TEST(PageTest, ImpossibleRecordsAreRefused) {
    const PageRecord good{0, 0, 1000, 3, 6, 1, 0};
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
    EXPECT_TRUE(bad([](PageRecord& r) { r.flags = 8; }));
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
