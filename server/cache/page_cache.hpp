#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <thread>
#include <tuple>
#include <vector>

#include "common/dataset/page.hpp"
#include "common/file.hpp"
#include "server/cache/arena.hpp"

namespace iwalk {

// A page in the arena, decoded; valid until PageCache::release().
struct ResidentPage {
    std::uint32_t page = 0;
    ArenaPlace place;
    const PageTable* table = nullptr;
    bool fetched = false;  // read since beginFrame()
};

// The geometry cache: pages of a dataset, decoded into an arena of bounded size by fetch threads.
//
// A frame names the pages that it wants and takes them in that order, whatever is resident already, so what
// is drawn does not depend on timing. A frame may want more than fits: it is then drawn in batches, giving
// drawn pages back with release() when next() asks for it. Memory is taken first from pages that the frame
// does not want (longest unused first), then from drawn ones (last drawn first: the next frame will want the
// first ones first), then from those that come last in the frame. Owned and called by the drawing thread.
class PageCache {
  public:
    // What the pages of one frame cost.
    struct Counters {
        std::uint64_t fetchedBytes = 0;  // read from disk
        std::uint64_t fetchedPages = 0;
        std::uint64_t stalls = 0;    // times that next() had to wait
        std::uint64_t badPages = 0;  // wanted, but unreadable
        double waitMs = 0;           // time spent waiting in next()
    };

    // `files` are the dataset's page files, in the manifest's order. Every page must fit in the arena's
    // largest bank.
    PageCache(const Hierarchy& hierarchy, std::vector<std::unique_ptr<RandomAccessFile>> files, Arena arena,
              unsigned fetchThreads);
    ~PageCache();
    PageCache(const PageCache&) = delete;
    PageCache& operator=(const PageCache&) = delete;

    // Begins a frame that will take `pages` (each once) with next(), in this order. All handed out before
    // must have been released.
    void beginFrame(std::vector<std::uint32_t> pages);
    // The frame will take `pages` behind those it was begun with, each once in this call. They may be pages
    // that it has taken before.
    void continueFrame(std::span<const std::uint32_t> pages);

    enum class Answer {
        page,     // `page` is the next one
        skipped,  // the next page cannot be read (said once in the log, tried again in the next frame that
                  // wants it): the frame goes on without it
        full,     // drawn pages hold all the memory: release() them, then ask again
        end,      // no more pages in this frame
    };
    struct Next {
        Answer answer = Answer::end;
        ResidentPage page;
    };
    Next next();

    // The GPU is done with all pages handed out so far: their memory may be used again.
    void release();

    Counters counters() const;  // of the frame under way

  private:
    enum class State : std::uint8_t { absent, loading, resident, bad };
    // Who gives way first: class, then rank in the class, then page.
    using Victim = std::tuple<int, std::int64_t, std::uint32_t>;
    struct Entry {
        State state = State::absent;
        bool reported = false;       // its being bad has been said
        std::uint64_t frame = 0;     // the last frame that wanted it
        std::uint64_t fetched = 0;   // the frame that it was read in
        std::uint32_t position = 0;  // in that frame
        Victim key;                  // while in evictable_
        ArenaPlace place;
        PageTable table;
    };

    void fetchLoop();
    std::optional<std::uint32_t> nextAbsent();
    std::optional<ArenaPlace> makeRoom(std::uint64_t bytes, std::uint32_t position);
    std::optional<ArenaPlace> waitForRoom(std::uint32_t page, std::unique_lock<std::mutex>& lock);
    void load(std::uint32_t page, std::unique_lock<std::mutex>& lock, std::vector<std::byte>& buffer);
    Result<PageTable> readPage(std::uint32_t page, std::vector<std::byte>& buffer,
                               std::span<std::byte> out) const;
    void makeEvictable(std::uint32_t page);

    const Hierarchy& hierarchy_;
    const std::vector<std::unique_ptr<RandomAccessFile>> files_;

    mutable std::mutex mutex_;  // guards all below
    std::condition_variable work_, arrival_;
    Arena arena_;
    std::vector<Entry> entries_;  // by page
    std::set<Victim> evictable_;
    std::uint64_t frame_ = 0;
    std::vector<std::uint32_t> wanted_;
    std::uint32_t fetchCursor_ = 0, drawCursor_ = 0;  // positions in wanted_
    std::vector<std::uint32_t> pinned_;
    std::set<std::uint32_t> starving_;  // positions of pages that wait for room
    Counters counters_;
    bool stop_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace iwalk
