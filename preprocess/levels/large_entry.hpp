#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "preprocess/build/packer.hpp"
#include "preprocess/build/spill.hpp"
#include "preprocess/levels/level_slice.hpp"

namespace iwalk {

// What a source of an entry becomes.
struct SourceImage {
    std::vector<RunSource> ranges;
    std::vector<std::uint32_t> records;  // of all ranges, one after the other
    std::vector<std::uint32_t> point;    // RangeImages::addPoint() of the first range in the entry's order
};
SourceImage imageOf(const LevelSource& source, RangeImages& images);

// An entry that is too large for memory, in pages: what its sources become lies in a spill file until all are
// there and the order is known, and only their ranges are in memory. The outcome is that of makeLevelSlice()
// and Packer.
class LargeEntry {
  public:
    LargeEntry(ChunkFile& file, const RecordFormat& format) : file_(file), words_(format.words()) {}
    ~LargeEntry();
    LargeEntry(const LargeEntry&) = delete;
    LargeEntry& operator=(const LargeEntry&) = delete;

    Result<void> add(const SourceImage& source);
    // All sources are added.
    Result<void> finish(std::size_t mostTriangles, unsigned leastLevels);
    std::size_t pages() const { return pages_.size(); }
    // The triangles of the next page; of the node, and its cell, nothing is said.
    Result<Slice> next();

  private:
    struct Part {
        RunSource range;
        std::uint64_t place;  // of its records: words into the file
    };
    Result<void> append(std::span<const std::uint32_t> words);
    Result<void> writeChunk();
    Result<void> read(const Part& part, std::vector<std::uint32_t>& records) const;
    std::size_t perChunk() const { return file_.chunkBytes() / sizeof(std::uint32_t); }

    ChunkFile& file_;
    std::size_t words_;
    std::vector<std::uint32_t> chunks_;  // of the file
    std::vector<std::uint32_t> buffer_;  // words behind them
    std::vector<Part> parts_;            // as they come, then in the entry's order
    std::vector<std::uint32_t> point_;   // SourceImage::point of the first of them
    std::pair<std::uint64_t, unsigned> pointOrder_;
    std::vector<Run> runs_;
    std::vector<std::size_t> pages_;  // cutPages()
    LatticeBox box_;
    std::size_t nextPage_ = 0, nextRun_ = 0, nextPart_ = 0, done_ = 0;  // done: triangles
};

}  // namespace iwalk
