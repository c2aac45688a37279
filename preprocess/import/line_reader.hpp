#pragma once

#include <string>
#include <string_view>

#include "preprocess/import/byte_stream.hpp"

namespace iwalk {

// The lines of a text file, ended by LF or CRLF; the last one need not be ended. A backslash at the end of a
// line joins it with the next, except in comments (lines that begin with '#'). Lines are at most 1 MiB long,
// joined ones as well.
class LineReader {
  public:
    // A byte order mark of UTF-8 is passed over. `file` and `path` must outlive the reader.
    LineReader(const RandomAccessFile& file, const std::string& path) : stream_(file), path_(path) {}

    // The next line, without its end; false when there is none. The view is void after the next call; behind
    // it stands a character that no number holds.
    Result<bool> next(std::string_view& line);

    std::uint64_t offset() const { return stream_.offset(); }  // behind the line, bytes
    // "PATH: line N: WHAT", with the number of the line last read (of a joined one the first).
    Error bad(std::string_view what) const;

  private:
    Result<bool> nextPhysical(std::string_view& line);
    Result<bool> join(std::string_view& line);

    ByteStream stream_;
    const std::string& path_;
    std::uint64_t line_ = 0, linesRead_ = 0;
    std::string joined_;
};

}  // namespace iwalk
