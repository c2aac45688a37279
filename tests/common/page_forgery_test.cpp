// Pages that are damaged, or made to do harm.
#include <gtest/gtest.h>
#include <meshoptimizer.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>

#include "tests/common/page_sample.hpp"

namespace iwalk {
namespace {

TEST(PageForgeryTest, EveryTruncationIsFound) {
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

TEST(PageForgeryTest, EveryFlippedByteIsFound) {
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

// As the stream of ranges has them.
struct RangeItem {
    std::uint32_t triangles, path;
    std::uint32_t boxMin[3], boxSize[3];
};

// A page whose contents were changed, with the checksums of what it has now.
class Forgery {
  public:
    explicit Forgery(const PageGeometry& page) : bytes_(encodePage(page, record_)) {
        for (const Range& range : page.ranges) {
            RangeItem& item = ranges.emplace_back(RangeItem{range.indexCount / 3, range.path, {}, {}});
            for (int axis = 0; axis < 3; ++axis) {
                item.boxMin[axis] = range.boxMin[axis];
                item.boxSize[axis] = range.boxMax[axis] - range.boxMin[axis];
            }
        }
    }

    template <class T>
    void put(std::size_t place, T value) {
        std::memcpy(bytes_.data() + place, &value, sizeof(T));
    }
    void setIndices(const std::vector<unsigned>& indices) {
        std::vector<std::byte> coded(meshopt_encodeIndexBufferBound(indices.size(), 65536));
        coded.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(coded.data()), coded.size(),
                                               indices.data(), indices.size()));
        replace(kIndexRecord, coded);
    }
    // What decoding says: "" when it takes the page.
    std::string decoded() {
        setRanges();
        for (std::size_t stream = kFirstRecord; stream <= kIndexRecord; stream += 16) {
            const std::uint32_t bytes = get(stream + 4);
            if (bytes > 0) put(stream + 8, XXH64(bytes_.data() + get(stream), bytes, 0));
        }
        put(kPageHeaderBytes - 8, XXH64(bytes_.data(), kPageHeaderBytes - 8, 0));
        std::vector<std::byte> out(pageLayout(record_).bytes);
        const auto table = decodePage(bytes_, record_, out);
        return table.ok() ? "" : table.error().message;
    }

    std::vector<RangeItem> ranges;

  private:
    static constexpr std::size_t kFirstRecord = 48, kIndexRecord = 112;

    std::uint32_t get(std::size_t place) const {
        std::uint32_t value = 0;
        std::memcpy(&value, bytes_.data() + place, sizeof(value));
        return value;
    }
    void setRanges() {
        std::vector<std::byte> coded(meshopt_encodeVertexBufferBound(ranges.size(), sizeof(RangeItem)));
        coded.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(coded.data()), coded.size(),
                                                ranges.data(), ranges.size(), sizeof(RangeItem)));
        replace(kFirstRecord, coded);
    }
    // Puts other bytes in a stream's place; those behind it move.
    void replace(std::size_t record, std::span<const std::byte> coded) {
        const std::uint32_t offset = get(record), before = get(record + 4);
        const auto at = bytes_.begin() + offset;
        bytes_.insert(bytes_.erase(at, at + before), coded.begin(), coded.end());
        const auto size = static_cast<std::uint32_t>(coded.size());
        put(record + 4, size);
        for (std::size_t next = record + 16; next <= kIndexRecord; next += 16) {
            if (get(next) > 0) put(next, get(next) + size - before);
        }
        record_.bytes = static_cast<std::uint32_t>(bytes_.size());
    }

    PageRecord record_{};
    std::vector<std::byte> bytes_;
};

// Checksums that are right do not make the contents right.
TEST(PageForgeryTest, WrongContentsAreFound) {
    const PageGeometry page = makePage(20, 21, 0);
    const auto refused = [&](const char* why, const auto& change) {
        Forgery forgery(page);
        change(forgery);
        const std::string message = forgery.decoded();
        EXPECT_NE(message.find(why), std::string::npos) << why << ": " << message;
    };
    EXPECT_EQ(Forgery(page).decoded(), "");
    std::vector<unsigned> indices(page.indices.begin(), page.indices.end());
    refused("", [&](Forgery& f) { f.setIndices(indices); });
    indices[10] = static_cast<unsigned>(page.vertices.size());
    refused("vertex 22 of 22", [&](Forgery& f) { f.setIndices(indices); });
    refused("cover 57 of 60", [&](Forgery& f) { --f.ranges[1].triangles; });
    refused("range 1: 11 triangles of 10", [&](Forgery& f) { ++f.ranges[1].triangles; });
    refused("triangles of 10", [&](Forgery& f) { f.ranges[1].triangles += 0x80000000; });
    refused("range 0: 0 triangles", [&](Forgery& f) { f.ranges[0].triangles = 0; });
    refused("box is too large", [&](Forgery& f) { f.ranges[0].boxMin[1] = ~f.ranges[0].boxSize[1] + 1; });
    refused("ranges: cannot be decoded", [&](Forgery& f) { f.ranges.resize(80); });
    for (const std::uint32_t path : {0u, 2u, 7u, 0x10u, 0x80000000u}) {
        refused("no path", [&](Forgery& f) { f.ranges[0].path = path; });
    }
    refused("origin out of bounds", [](Forgery& f) { f.put(24, kLatticeLimit + 1); });
    refused("version 0, but", [](Forgery& f) { f.put(4, 0); });
}

}  // namespace
}  // namespace iwalk
