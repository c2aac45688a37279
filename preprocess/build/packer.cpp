#include "preprocess/build/packer.hpp"

#include <algorithm>
#include <utility>

#include "preprocess/build/grid.hpp"

namespace iwalk {
namespace {

// Small nodes share a page only when the page stays at most this many of its smallest cells wide: what is
// read together should be seen together.
constexpr int kSharedCellsLog2 = 2;

bool isWide(const LatticeBox& box) {
    return box.edge() >= std::int64_t{1} << kNarrowBits;
}

// Triangles [begin, end) of a slice.
Slice part(const Slice& slice, std::size_t begin, std::size_t end, std::size_t words) {
    Slice result;
    result.node = slice.node;
    result.edgeLog2 = slice.edgeLog2;
    result.box = slice.box;
    result.leastLevels = slice.leastLevels;
    result.group = slice.group;
    result.count = end - begin;
    result.records = slice.order != nullptr ? slice.records : slice.records + begin * words;
    result.order = slice.order != nullptr ? slice.order + begin : nullptr;
    return result;
}

void own(Slice& slice, std::size_t words) {
    if (!slice.owned.empty()) return;
    slice.owned.reserve(slice.count * words);
    for (std::size_t i = 0; i < slice.count; ++i) {
        const std::uint32_t* record = slice.record(i, words);
        slice.owned.insert(slice.owned.end(), record, record + words);
    }
    slice.records = slice.owned.data();
    slice.order = nullptr;
}

}  // namespace

std::vector<std::size_t> cutPages(std::span<const Run> runs, std::size_t mostTriangles) {
    const std::size_t triangles = runs.back().end;
    const std::size_t pages = (triangles + mostTriangles - 1) / mostTriangles;
    const std::size_t share = (triangles + pages - 1) / pages;
    std::vector<std::size_t> ends;
    for (std::size_t first = 0, next = 0, begin = 0; first < runs.size(); first = next) {
        while (next < runs.size() && (next == first || runs[next].end - begin <= share)) ++next;
        begin = runs[next - 1].end;
        ends.push_back(next);
    }
    return ends;
}

Packer::Packer(const RecordFormat& format, std::size_t mostTriangles)
    : format_(format), words_(format.words()), most_(std::min(mostTriangles, kMaxPageTriangles)) {}

bool Packer::fits(const Slice& slice) const {
    if (waitingTriangles_ + slice.count > most_) return false;
    if (!waiting_.slices.empty() && waiting_.slices[0].group != slice.group) return false;
    LatticeBox box = waitingBox_;
    box.add(slice.box);
    bool partsWide = isWide(slice.box);
    unsigned smallest = slice.edgeLog2;
    for (const Slice& waiting : waiting_.slices) {
        partsWide = partsWide || isWide(waiting.box);
        smallest = std::min(smallest, waiting.edgeLog2);
    }
    if (isWide(box) && !partsWide) return false;
    return box.edge() <= std::int64_t{1} << (smallest + kSharedCellsLog2);
}

void Packer::add(Slice slice, std::uint64_t total) {
    if (total > most_) return addLarge(std::move(slice), total);
    if (!fits(slice)) closeShared();
    waitingTriangles_ += slice.count;
    waitingBox_.add(slice.box);
    waiting_.slices.push_back(std::move(slice));
}

void Packer::add(Slice slice) {
    CHECK(!slice.runs.empty());
    if (slice.count > most_) return addPieces(slice);
    const std::uint64_t total = slice.count;
    add(std::move(slice), total);
}

void Packer::addPieces(const Slice& slice) {
    closeShared();
    std::size_t first = 0, begin = 0;
    for (const std::size_t next : cutPages(slice.runs, most_)) {
        const std::size_t end = slice.runs[next - 1].end;
        Slice piece = part(slice, begin, end, words_);
        own(piece, words_);
        for (std::size_t run = first; run < next; ++run) {
            piece.runs.push_back(slice.runs[run]);
            piece.runs.back().end -= begin;
        }
        first = next, begin = end;
        complete_.push_back({{}, {}});
        complete_.back().slices.push_back(std::move(piece));
    }
}

void Packer::addLarge(Slice slice, std::uint64_t total) {
    if (largeDone_ == 0) closeShared();
    const std::uint64_t pages = (total + most_ - 1) / most_;
    CHECK(slice.owned.empty());
    std::size_t begin = 0;
    while (begin < slice.count) {
        // Page p has triangles [p total / pages, (p + 1) total / pages).
        std::uint64_t page = largeDone_ * pages / total;
        if ((page + 1) * total / pages <= largeDone_) ++page;
        const std::uint64_t pageEnd = (page + 1) * total / pages;
        const std::size_t end =
            static_cast<std::size_t>(std::min<std::uint64_t>(slice.count, begin + (pageEnd - largeDone_)));
        if (pageFull_) closeLarge(keyOf(slice, begin));
        waiting_.slices.push_back(part(slice, begin, end, words_));
        largeDone_ += end - begin;
        pageFull_ = largeDone_ == pageEnd;
        begin = end;
    }
    if (largeDone_ < total) return;
    closeLarge(std::nullopt);
    waiting_.around = {};
    largeDone_ = 0;
}

// One page of a large node, whose next triangle has this key. The next page will know the last of this one.
void Packer::closeLarge(std::optional<std::uint64_t> keyAfter) {
    const Slice& last = waiting_.slices.back();
    const std::uint64_t before = keyOf(last, last.count - 1);
    waiting_.around.after = keyAfter;
    closeShared();
    waiting_.around.before = before;
    pageFull_ = false;
}

std::uint64_t Packer::keyOf(const Slice& slice, std::size_t i) const {
    return sortKey(format_.place(slice.record(i, words_)), slice.edgeLog2);
}

void Packer::closeShared() {
    if (!waiting_.slices.empty()) complete_.push_back(std::exchange(waiting_, {}));
    waitingTriangles_ = 0;
    waitingBox_ = {};
}

void Packer::keep() {
    for (Slice& slice : waiting_.slices) own(slice, words_);
}

}  // namespace iwalk
