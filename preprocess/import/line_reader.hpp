#pragma once

#include "preprocess/import/line_blocks.hpp"

namespace iwalk {

// The lines of a whole file, for what is not parsed in blocks.
class LineReader {
  public:
    // `file` and `path` must outlive the reader.
    LineReader(const RandomAccessFile& file, const std::string& path)
        : blocks_(file, kBlockBytes), path_(path) {}

    // The next line, without its end; false when there is none. The view is void after the next call; behind
    // it stands a character that no number holds.
    Result<bool> next(std::string_view& line);

    std::uint64_t offset() const { return block_.bytes.offset(); }  // of the line's block, bytes
    // "PATH: line N: WHAT", with the number of the line last read (of a joined one the first).
    Error bad(std::string_view what) const;

  private:
    static constexpr std::size_t kBlockBytes = std::size_t{64} << 10;

    LineBlocks blocks_;
    LineBlock block_;
    Lines lines_;
    std::uint64_t before_ = 0;  // lines, before the block
    const std::string& path_;
};

}  // namespace iwalk
