#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "preprocess/import/importer.hpp"
#include "preprocess/import/spill_file.hpp"

// What iwalk-import writes and iwalk-preprocess reads, on one machine: a header, then blocks, each behind its
// size and checksum, then an empty block that holds their number.
namespace iwalk {

struct ExchangeHeader {
    static constexpr std::uint64_t kMagic = 0x3154524f504d4957;   // "WIMPORT1"
    static constexpr std::uint32_t kTriangles = 1, kHeights = 2;  // kinds
    static constexpr std::uint32_t kColors = 1, kNormals = 2;     // flags, of triangles

    std::uint64_t magic = kMagic;
    std::uint32_t kind = kTriangles;
    std::uint32_t flags = 0;
    std::uint64_t columns = 0, rows = 0;  // of heights
};
struct ExchangeBlock {
    std::uint64_t bytes = 0;     // behind it
    std::uint64_t checksum = 0;  // xxHash of them; of the empty block: the number of blocks
};
inline constexpr std::size_t kMostBlockBytes = std::size_t{4} << 20;
// Of the triangles in a block, as they are in memory.
inline constexpr std::size_t kBlockTriangles = 4096;
// Of a row of heights, which is a block: floats.
inline constexpr std::uint64_t kMostColumns = kMostBlockBytes / sizeof(float);
static_assert(std::is_trivially_copyable_v<Triangle> && sizeof(Triangle) == 120);

class ExchangeWriter {
  public:
    explicit ExchangeWriter(int descriptor) : descriptor_(descriptor) {}
    Result<void> header(const ExchangeHeader& header);
    Result<void> block(std::span<const std::byte> bytes);
    Result<void> finish();

  private:
    Result<void> write(std::span<const std::byte> bytes) const;
    int descriptor_;
    std::uint64_t blocks_ = 0;
};

// Nothing of what it reads is believed: the program that wrote it may have been led astray by a bad file.
class ExchangeReader {
  public:
    // `name` is for messages. Both must outlive the reader.
    ExchangeReader(const SpillFile& file, const std::string& name) : file_(file), name_(name) {}

    Result<ExchangeHeader> header();
    // The next block; empty at the end. Void after the next call.
    Result<std::span<const std::byte>> block();
    std::uint64_t offset() const { return offset_; }  // bytes

  private:
    Error damaged() const;
    const SpillFile& file_;
    const std::string& name_;
    std::uint64_t offset_ = 0, blocks_ = 0;
    std::vector<std::byte> bytes_;
};

}  // namespace iwalk
