#include "server/cache/page_cache.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <numeric>
#include <random>
#include <set>

namespace iwalk {
namespace {

// A page file in memory that can fail, be slow, or lie.
class FakeFile : public RandomAccessFile {
  public:
    Result<void> readAt(std::uint64_t offset, std::span<std::byte> out) const override {
        ++reads;
        if (delayUs > 0) std::this_thread::sleep_for(std::chrono::microseconds(delayUs));
        if (failing.contains(offset)) return fail("pages: input/output error at {}", offset);
        if (offset + out.size() > bytes.size()) return fail("pages: ends before {}", offset + out.size());
        std::memcpy(out.data(), bytes.data() + offset, out.size());
        if (flipped.contains(offset)) out[out.size() / 2] ^= std::byte{1};
        return {};
    }
    std::uint64_t size() const override { return bytes.size(); }

    std::vector<std::byte> bytes;
    std::set<std::uint64_t> failing, flipped;  // offsets of pages
    int delayUs = 0;
    mutable std::atomic<int> reads = 0;
};

// Pages of one triangle each, told apart by their vertices.
class PageCacheTest : public ::testing::Test {
  protected:
    static constexpr std::uint32_t kPages = 64;

    void SetUp() override {
        auto owned = std::make_unique<FakeFile>();
        file_ = owned.get();
        for (std::uint32_t p = 0; p < kPages; ++p) {
            PageGeometry page;
            for (std::uint32_t v = 0; v < 3; ++v) page.vertices.push_back({{p, v, v * v}, 0, 0});
            page.indices = {0, 1, 2};
            page.ranges = {{0, 3, kRootPath, {0, 0, 0}, {p, 2, 4}}};
            PageRecord record{};
            const std::vector<std::byte> bytes = encodePage(page, record);
            record.offset = file_->bytes.size();
            record.bytes = static_cast<std::uint32_t>(bytes.size());
            file_->bytes.insert(file_->bytes.end(), bytes.begin(), bytes.end());
            hierarchy_.pages.push_back(record);
        }
        files_.push_back(std::move(owned));
    }

    // A cache with room for `pages` pages.
    PageCache& make(std::uint32_t pages, unsigned threads) {
        memory_.resize(std::size_t{pages} * pageLayout(hierarchy_.pages[0]).bytes);
        cache_ = std::make_unique<PageCache>(hierarchy_, std::move(files_), Arena({memory_}, 256), threads);
        return *cache_;
    }

    // Draws a frame; checks that pages come in order with their own bytes. Returns how often memory was full.
    int drawFrame(const std::vector<std::uint32_t>& pages) {
        cache_->beginFrame(pages);
        const int full = takeAll(pages);
        cache_->release();
        return full;
    }
    int takeAll(const std::vector<std::uint32_t>& pages) {
        int full = 0;
        for (std::size_t i = 0;; ++i) {
            PageCache::Next next = cache_->next();
            for (; next.answer == PageCache::Answer::full; next = cache_->next()) {
                ++full;
                cache_->release();
            }
            if (next.answer == PageCache::Answer::end) {
                EXPECT_EQ(i, pages.size());
                break;
            }
            if (next.answer == PageCache::Answer::skipped) continue;
            EXPECT_EQ(next.page.page, pages[i]);
            const std::span<const std::byte> bytes(memory_.data() + next.page.place.offset,
                                                   next.page.place.bytes);
            for (std::uint32_t v = 0; v < 3; ++v)
                EXPECT_EQ(pageOffset(bytes, hierarchy_.pages[pages[i]], v), glm::u32vec3(pages[i], v, v * v));
        }
        return full;
    }

    static std::vector<std::uint32_t> range(std::uint32_t from, std::uint32_t to) {
        std::vector<std::uint32_t> pages(to - from);
        std::iota(pages.begin(), pages.end(), from);
        return pages;
    }

    Hierarchy hierarchy_;
    std::vector<std::byte> memory_;
    FakeFile* file_ = nullptr;
    std::vector<std::unique_ptr<RandomAccessFile>> files_;
    std::unique_ptr<PageCache> cache_;
};

TEST_F(PageCacheTest, ReadsEachPageOnceWhenAllFit) {
    make(kPages, 3);
    for (int frame = 0; frame < 3; ++frame) EXPECT_EQ(drawFrame(range(0, kPages)), 0);
    EXPECT_EQ(file_->reads, static_cast<int>(kPages));
    EXPECT_EQ(cache_->counters().fetchedBytes, 0u);
}

TEST_F(PageCacheTest, DrawsInBatchesWhatDoesNotFit) {
    make(5, 4);
    EXPECT_GT(drawFrame(range(0, kPages)), 0);
    EXPECT_EQ(cache_->counters().fetchedPages, kPages);
}

TEST_F(PageCacheTest, OnePageOfRoomIsEnough) {
    make(1, 2);
    for (int frame = 0; frame < 3; ++frame) drawFrame(range(0, 20));
}

// A walk that wants the same pages again and again finds most of those that fit, not none as with the least
// recently used rule alone.
TEST_F(PageCacheTest, KeepsWhatTheNextFrameWantsFirst) {
    make(32, 1);
    drawFrame(range(0, 40));
    drawFrame(range(0, 40));
    drawFrame(range(0, 40));
    EXPECT_LE(cache_->counters().fetchedPages, 16u);
}

TEST_F(PageCacheTest, TakesMemoryFromWhatWasUnusedLongest) {
    make(30, 1);
    drawFrame(range(0, 10));
    drawFrame(range(10, 20));
    drawFrame(range(20, 30));
    drawFrame(range(30, 40));
    drawFrame(range(10, 20));
    EXPECT_EQ(cache_->counters().fetchedPages, 0u);
    drawFrame(range(0, 10));
    EXPECT_EQ(cache_->counters().fetchedPages, 10u);
}

TEST_F(PageCacheTest, GoesOnWithoutPagesThatCannotBeRead) {
    file_->failing = {hierarchy_.pages[3].offset};
    file_->flipped = {hierarchy_.pages[7].offset};
    make(kPages, 2);
    drawFrame(range(0, 20));
    EXPECT_EQ(cache_->counters().badPages, 2u);

    // A disk that comes back heals the picture.
    file_->failing.clear();
    drawFrame(range(0, 20));
    EXPECT_EQ(cache_->counters().badPages, 1u);
}

TEST_F(PageCacheTest, SlowDiskAndChangingFramesStayInOrder) {
    file_->delayUs = 200;
    make(9, 4);
    std::mt19937 random(3);
    std::vector<std::uint32_t> pages = range(0, kPages);
    for (int frame = 0; frame < 30; ++frame) {
        std::shuffle(pages.begin(), pages.end(), random);
        drawFrame({pages.begin(), pages.begin() + 1 + random() % 30});
    }
}

TEST_F(PageCacheTest, AFrameMayGoOn) {
    make(kPages, 2);
    cache_->beginFrame(range(0, 10));
    EXPECT_EQ(takeAll(range(0, 10)), 0);
    for (const std::uint32_t from : {5u, 0u, 12u}) {  // some are taken already, and not given back
        cache_->continueFrame(range(from, from + 10));
        EXPECT_EQ(takeAll(range(from, from + 10)), 0);
    }
    cache_->release();
    EXPECT_EQ(file_->reads, 22);
    EXPECT_EQ(cache_->counters().fetchedPages, 22u);
    EXPECT_EQ(drawFrame(range(0, 22)), 0);
    EXPECT_EQ(file_->reads, 22);
}

TEST_F(PageCacheTest, AFrameMayGoOnInLittleMemory) {
    file_->delayUs = 50;
    make(4, 3);
    std::mt19937 random(4);
    std::vector<std::uint32_t> pages = range(0, kPages);
    for (int frame = 0; frame < 20; ++frame) {
        cache_->beginFrame({});
        for (int part = 0; part < 5; ++part) {
            std::shuffle(pages.begin(), pages.end(), random);
            const std::vector<std::uint32_t> some(pages.begin(), pages.begin() + 1 + random() % 12);
            cache_->continueFrame(some);
            takeAll(some);
        }
        cache_->release();
    }
}

TEST_F(PageCacheTest, EndsWhilePagesAreBeingFetched) {
    file_->delayUs = 2000;
    make(4, 2);
    cache_->beginFrame(range(0, kPages));
    cache_->next();
    cache_.reset();
}

}  // namespace
}  // namespace iwalk
