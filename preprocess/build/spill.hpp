#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

// A temporary file of fixed-size chunks; chunks that are read for the last time are used again.
class ChunkFile {
  public:
    // Creates `path`; it is removed from the directory at once, so that nothing is left whatever happens.
    static Result<ChunkFile> create(const std::string& path, std::size_t chunkBytes);
    ChunkFile(ChunkFile&& other) noexcept;
    ChunkFile& operator=(ChunkFile&& other) noexcept;
    ~ChunkFile();

    std::size_t chunkBytes() const { return chunkBytes_; }
    Result<std::uint32_t> write(std::span<const std::byte> chunk);  // at most chunkBytes()
    // From byte `inChunk` of the chunk on.
    Result<void> read(std::uint32_t chunk, std::span<std::byte> out, std::size_t inChunk = 0) const;
    void release(std::uint32_t chunk) { free_.push_back(chunk); }

  private:
    ChunkFile(std::string path, int descriptor, std::size_t chunkBytes)
        : path_(std::move(path)), descriptor_(descriptor), chunkBytes_(chunkBytes) {}

    std::string path_;
    int descriptor_ = -1;
    std::size_t chunkBytes_ = 0;
    std::uint32_t chunks_ = 0;
    std::vector<std::uint32_t> free_;
};

// Records of one bin, in the order they came.
struct Bin {
    std::vector<std::uint32_t> chunks;
    std::uint64_t count = 0;
};

// Sorts records into bins of a spill file through one buffer of a chunk for each bin that is used.
class BinWriter {
  public:
    BinWriter(ChunkFile& file, std::size_t bins, std::size_t recordWords);

    // The place for the next record of `bin`; to be filled before the next call.
    Result<std::uint32_t*> append(std::size_t bin) {
        Buffer& buffer = buffers_[bin];
        if (buffer.used == perChunk_ || buffer.words.empty()) RETURN_IF_ERROR(makeRoom(bin));
        ++bins_[bin].count;
        return buffer.words.data() + buffer.used++ * recordWords_;
    }
    // Writes what is left; the writer is done with.
    Result<std::vector<Bin>> finish();

  private:
    struct Buffer {
        std::vector<std::uint32_t> words;
        std::size_t used = 0;  // records
    };
    Result<void> makeRoom(std::size_t bin);
    Result<void> writeChunk(std::size_t bin);

    ChunkFile& file_;
    std::size_t recordWords_, perChunk_;
    std::vector<Buffer> buffers_;
    std::vector<Bin> bins_;
};

// Reads a bin piece by piece and gives its chunks back.
class BinReader {
  public:
    BinReader(ChunkFile& file, Bin bin, std::size_t recordWords);
    std::uint64_t left() const { return bin_.count; }  // records
    // Appends the next records, at least one and at most a chunk of them, to `out`.
    Result<void> next(std::vector<std::uint32_t>& out);

  private:
    ChunkFile& file_;
    Bin bin_;
    std::size_t recordWords_, perChunk_, nextChunk_ = 0;
};

}  // namespace iwalk
