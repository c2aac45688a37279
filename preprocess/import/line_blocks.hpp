#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "preprocess/import/text_block.hpp"

namespace iwalk {

// Lines of a text file end with LF or CRLF; the last one need not be ended. A backslash at the end of a line
// joins it with the next, except in comments (lines that begin with '#'). Lines are at most 1 MiB long,
// joined ones as well, with the ends of their parts.
inline constexpr std::size_t kMaxLine = std::size_t{1} << 20;  // bytes

// What is wrong with a line of a block, counted from the block's first, 0.
struct BadLine {
    std::uint64_t line = 0;
    std::string what;

    // "PATH: line N: WHAT" where `before` lines come before the block.
    Error error(const std::string& path, std::uint64_t before) const;
};

// Some whole lines; one that is longer than a block should be is alone in one.
struct LineBlock {
    TextBlock bytes;
    std::optional<BadLine> bad;  // the first; to begin with, when it is less than a line, that it is
};

// Cuts a file into blocks of lines.
class LineBlocks {
  public:
    // `file` must outlive it. Blocks are `blockBytes` long at most, as a rule.
    LineBlocks(const RandomAccessFile& file, std::size_t blockBytes) : file_(file), blockBytes_(blockBytes) {}
    Result<bool> next(LineBlock& block);  // false when there is none

  private:
    Result<void> cut(LineBlock& block);

    const RandomAccessFile& file_;
    std::size_t blockBytes_;
    std::uint64_t offset_ = 0;
};

// The lines of a block, one after the other.
class Lines {
  public:
    Lines() = default;
    // `block` must outlive it. A byte order mark of UTF-8 at the file's beginning is passed over.
    explicit Lines(const LineBlock& block);

    // The next line, without its end; false when there is none. The view is void after the next call; behind
    // it stands a character that no number holds.
    bool next(std::string_view& line);
    // Of the line last read, from 0; of a joined one that of its first part.
    std::uint64_t number() const { return line_; }
    std::uint64_t linesRead() const { return linesRead_; }

  private:
    bool nextPhysical(std::string_view& line);
    void join(std::string_view& line);

    std::string_view rest_;
    std::uint64_t line_ = 0, linesRead_ = 0;
    std::string joined_;
};

}  // namespace iwalk
