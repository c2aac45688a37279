#include "server/cache/page_cache.hpp"

#include <spdlog/spdlog.h>

#include <chrono>

namespace iwalk {
namespace {

enum VictimClass { kNotWanted = 0, kDrawn = 1, kWanted = 2 };

}  // namespace

PageCache::PageCache(const Hierarchy& hierarchy, std::vector<std::unique_ptr<RandomAccessFile>> files,
                     Arena arena, unsigned fetchThreads)
    : hierarchy_(hierarchy),
      files_(std::move(files)),
      arena_(std::move(arena)),
      entries_(hierarchy.pages.size()) {
    for (const PageRecord& page : hierarchy.pages) CHECK_OP(pageLayout(page).bytes, <=, arena_.largestBank());
    for (unsigned i = 0; i < std::max(1u, fetchThreads); ++i) threads_.emplace_back([this] { fetchLoop(); });
}

PageCache::~PageCache() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    work_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void PageCache::beginFrame(std::vector<std::uint32_t> pages) {
    const std::lock_guard lock(mutex_);
    CHECK(pinned_.empty());
    ++frame_;
    wanted_ = std::move(pages);
    fetchCursor_ = drawCursor_ = 0;
    counters_ = {};
    for (std::uint32_t position = 0; position < wanted_.size(); ++position) {
        Entry& entry = entries_[wanted_[position]];
        CHECK_OP(entry.frame, !=, frame_);
        entry.frame = frame_;
        entry.position = position;
        if (entry.state == State::bad) entry.state = State::absent;
    }
    evictable_.clear();
    for (std::uint32_t page = 0; page < entries_.size(); ++page)
        if (entries_[page].state == State::resident) makeEvictable(page);
    work_.notify_all();
}

void PageCache::continueFrame(std::span<const std::uint32_t> pages) {
    const std::lock_guard lock(mutex_);
    CHECK_OP(drawCursor_, ==, wanted_.size());
    for (const std::uint32_t page : pages) {
        Entry& entry = entries_[page];
        const bool evictable = evictable_.erase(entry.key) > 0;
        entry.frame = frame_;
        entry.position = static_cast<std::uint32_t>(wanted_.size());
        wanted_.push_back(page);
        if (evictable) makeEvictable(page);
    }
    work_.notify_all();
}

PageCache::Next PageCache::next() {
    std::unique_lock lock(mutex_);
    if (drawCursor_ == wanted_.size()) return {};
    const std::uint32_t page = wanted_[drawCursor_];
    Entry& entry = entries_[page];
    const auto arrived = [&] { return entry.state == State::resident || entry.state == State::bad; };
    const auto stuck = [&] { return !starving_.empty() && !pinned_.empty(); };
    if (!arrived()) {
        const auto start = std::chrono::steady_clock::now();
        ++counters_.stalls;
        arrival_.wait(lock, [&] { return arrived() || stuck(); });
        counters_.waitMs +=
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        if (!arrived()) return {Answer::full, {}};
    }
    ++drawCursor_;
    if (entry.state == State::bad) {
        ++counters_.badPages;
        return {Answer::skipped, {}};
    }
    evictable_.erase(entry.key);
    pinned_.push_back(page);
    return {Answer::page, {page, entry.place, &entry.table, entry.fetched == frame_}};
}

void PageCache::release() {
    const std::lock_guard lock(mutex_);
    for (const std::uint32_t page : pinned_) makeEvictable(page);
    pinned_.clear();
    work_.notify_all();
}

PageCache::Counters PageCache::counters() const {
    const std::lock_guard lock(mutex_);
    return counters_;
}

void PageCache::fetchLoop() {
    std::vector<std::byte> buffer;
    std::unique_lock lock(mutex_);
    while (true) {
        std::optional<std::uint32_t> page;
        work_.wait(lock, [&] { return stop_ || (page = nextAbsent()); });
        if (stop_) return;
        load(*page, lock, buffer);
    }
}

// The first wanted page that nobody has or fetches yet.
std::optional<std::uint32_t> PageCache::nextAbsent() {
    // What was evicted behind the cursor is fetched again when its turn to be drawn comes near.
    for (fetchCursor_ = std::max(fetchCursor_, drawCursor_); fetchCursor_ < wanted_.size(); ++fetchCursor_)
        if (entries_[wanted_[fetchCursor_]].state == State::absent) return wanted_[fetchCursor_];
    return std::nullopt;
}

// A free place of `bytes`, evicting what may give way to the page at `position`; nothing when all that is
// left is pinned, being loaded, or wanted earlier.
std::optional<ArenaPlace> PageCache::makeRoom(std::uint64_t bytes, std::uint32_t position) {
    while (true) {
        if (std::optional<ArenaPlace> place = arena_.allocate(bytes)) return place;
        if (evictable_.empty()) return std::nullopt;
        const auto [kind, rank, page] = *evictable_.begin();
        Entry& entry = entries_[page];
        if (kind == kWanted && entry.position <= position) return std::nullopt;
        evictable_.erase(evictable_.begin());
        arena_.free(entry.place);
        entry.state = State::absent;
        entry.table = {};
        if (kind == kWanted) fetchCursor_ = std::min(fetchCursor_, entry.position);
    }
}

// Pages that wait get room in the order in which they will be drawn; nothing only when the cache ends.
std::optional<ArenaPlace> PageCache::waitForRoom(std::uint32_t page, std::unique_lock<std::mutex>& lock) {
    const std::uint32_t position = entries_[page].position;
    const std::uint64_t bytes = pageLayout(hierarchy_.pages[page]).bytes;
    std::optional<ArenaPlace> place;
    starving_.insert(position);
    while (!stop_ && (*starving_.begin() != position || !(place = makeRoom(bytes, position)))) {
        arrival_.notify_all();
        work_.wait(lock);
    }
    starving_.erase(position);
    if (!starving_.empty()) work_.notify_all();
    return place;
}

void PageCache::load(std::uint32_t page, std::unique_lock<std::mutex>& lock, std::vector<std::byte>& buffer) {
    Entry& entry = entries_[page];
    entry.state = State::loading;
    const std::optional<ArenaPlace> place = waitForRoom(page, lock);
    if (!place) return;

    // Reading and decoding need no lock: nobody else touches a page that is being loaded, nor its place.
    lock.unlock();
    Result<PageTable> table = readPage(page, buffer, arena_.memory(*place));
    lock.lock();

    counters_.fetchedBytes += hierarchy_.pages[page].bytes;
    ++counters_.fetchedPages;
    if (table.ok()) {
        entry.place = *place;
        entry.table = std::move(table).value();
        entry.state = State::resident;
        entry.fetched = frame_;
        makeEvictable(page);
    } else {
        if (!entry.reported) spdlog::error("{} (drawn without page {})", table.error().message, page);
        entry.reported = true;
        arena_.free(*place);
        entry.state = State::bad;
    }
    arrival_.notify_all();
    if (!starving_.empty()) work_.notify_all();
}

Result<PageTable> PageCache::readPage(std::uint32_t page, std::vector<std::byte>& buffer,
                                      std::span<std::byte> out) const {
    const PageRecord& record = hierarchy_.pages[page];
    buffer.resize(record.bytes);
    RETURN_IF_ERROR(files_[record.file]->readAt(record.offset, buffer));
    return decodePage(buffer, record, out.first(pageLayout(record).bytes));
}

void PageCache::makeEvictable(std::uint32_t page) {
    Entry& entry = entries_[page];
    const std::int64_t position = entry.position;
    if (entry.frame != frame_)
        entry.key = {kNotWanted, static_cast<std::int64_t>(entry.frame), page};
    else
        entry.key = {position < drawCursor_ ? kDrawn : kWanted, -position, page};
    evictable_.insert(entry.key);
}

}  // namespace iwalk
