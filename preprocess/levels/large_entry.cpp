#include "preprocess/levels/large_entry.hpp"

#include <algorithm>
#include <utility>

namespace iwalk {
namespace {

std::pair<std::uint64_t, unsigned> orderOf(const RunSource& range) {
    return {range.key, range.levels};
}

}  // namespace

SourceImage imageOf(const LevelSource& source, RangeImages& images) {
    SourceImage image;
    const std::span<const Range> ranges =
        std::span(source.page->ranges).subspan(source.firstRange, source.rangeCount);
    for (const Range& range : ranges) image.ranges.push_back(images.add(source, range, image.records));
    const auto first = std::ranges::min_element(image.ranges, {}, orderOf) - image.ranges.begin();
    if (!ranges.empty()) images.addPoint(source, ranges[static_cast<std::size_t>(first)], image.point);
    return image;
}

LargeEntry::~LargeEntry() {
    for (const std::uint32_t chunk : chunks_) file_.release(chunk);
}

Result<void> LargeEntry::add(const SourceImage& source) {
    std::uint64_t place = chunks_.size() * perChunk() + buffer_.size();
    for (const RunSource& range : source.ranges) {
        if (point_.empty() || orderOf(range) < pointOrder_)
            point_ = source.point, pointOrder_ = orderOf(range);
        parts_.push_back({range, place});
        box_.add(range.box);
        place += range.triangles * words_;
    }
    return append(source.records);
}

Result<void> LargeEntry::append(std::span<const std::uint32_t> words) {
    while (!words.empty()) {
        const std::size_t fits = std::min(words.size(), perChunk() - buffer_.size());
        buffer_.insert(buffer_.end(), words.begin(), words.begin() + static_cast<std::ptrdiff_t>(fits));
        words = words.subspan(fits);
        if (buffer_.size() == perChunk()) RETURN_IF_ERROR(writeChunk());
    }
    return {};
}

Result<void> LargeEntry::writeChunk() {
    ASSIGN_OR_RETURN(const std::uint32_t chunk, file_.write(std::as_bytes(std::span(buffer_))));
    chunks_.push_back(chunk);
    buffer_.clear();
    return {};
}

Result<void> LargeEntry::finish(std::size_t mostTriangles, unsigned leastLevels) {
    std::ranges::stable_sort(parts_, {}, [](const Part& part) { return orderOf(part.range); });
    std::vector<RunSource> ranges;
    std::size_t triangles = 0;
    for (const Part& part : parts_) triangles += part.range.triangles;
    if (triangles == 0) {
        parts_.front() = {parts_.front().range, chunks_.size() * perChunk() + buffer_.size()};
        parts_.front().range.triangles = 1;
        RETURN_IF_ERROR(append(point_));
    }
    if (!buffer_.empty()) RETURN_IF_ERROR(writeChunk());
    for (const Part& part : parts_) ranges.push_back(part.range);
    runs_ = joinRanges(ranges, leastLevels);
    pages_ = cutPages(runs_, mostTriangles);
    return {};
}

Result<Slice> LargeEntry::next() {
    Slice slice;
    slice.box = box_;
    for (const std::size_t begin = done_; nextRun_ < pages_[nextPage_]; ++nextRun_) {
        slice.runs.push_back(runs_[nextRun_]);
        done_ = std::exchange(slice.runs.back().end, slice.runs.back().end - begin);
    }
    ++nextPage_;
    slice.count = slice.runs.back().end;
    slice.owned.reserve(slice.count * words_);
    for (; slice.owned.size() < slice.count * words_; ++nextPart_)
        RETURN_IF_ERROR(read(parts_[nextPart_], slice.owned));
    slice.records = slice.owned.data();
    return slice;
}

// Appends the part's records.
Result<void> LargeEntry::read(const Part& part, std::vector<std::uint32_t>& records) const {
    std::uint64_t place = part.place;
    for (std::size_t left = part.range.triangles * words_; left > 0;) {
        const std::size_t inChunk = static_cast<std::size_t>(place % perChunk());
        const std::size_t words = std::min(left, perChunk() - inChunk);
        records.resize(records.size() + words);
        RETURN_IF_ERROR(file_.read(chunks_[static_cast<std::size_t>(place / perChunk())],
                                   std::as_writable_bytes(std::span(records).last(words)),
                                   inChunk * sizeof(std::uint32_t)));
        place += words, left -= words;
    }
    return {};
}

}  // namespace iwalk
