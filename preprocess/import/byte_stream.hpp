#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/file.hpp"

namespace iwalk {

// A file read front to back through one buffer, but for a seek here and there. The parsers look at bytes in
// place.
class ByteStream {
  public:
    // `file` must outlive the stream.
    explicit ByteStream(const RandomAccessFile& file, std::uint64_t offset = 0)
        : file_(file), loaded_(offset) {}

    // Makes view() hold at least `want` bytes, or all that the file still has. The buffer grows to `want`
    // when that is more than its usual 256 KiB, so callers pass bounded sizes. Views taken before are void.
    Result<void> fill(std::size_t want) { return size_ - begin_ >= want ? Result<void>() : refill(want); }
    // The bytes at hand from offset() on; one '\n' stands behind them, so a number needs no check for the
    // end.
    std::string_view view() const { return {buffer_.data() + begin_, size_ - begin_}; }
    void advance(std::size_t bytes) { begin_ += bytes; }  // at most view().size()
    void seek(std::uint64_t offset);

    std::uint64_t offset() const { return loaded_ - (size_ - begin_); }  // of view() in the file, bytes
    std::uint64_t rest() const { return file_.size() - offset(); }       // bytes from offset() to the end
    bool allLoaded() const { return loaded_ >= file_.size(); }           // view() reaches the end of the file

  private:
    // Small enough to stay in a core's cache between the read and the parser.
    static constexpr std::size_t kBufferBytes = std::size_t{256} << 10;

    Result<void> refill(std::size_t want);

    const RandomAccessFile& file_;
    std::uint64_t loaded_;  // the file's bytes before this one have been read
    std::vector<char> buffer_ = std::vector<char>(1, '\n');
    std::size_t begin_ = 0, size_ = 0;  // buffer_[begin_, size_) is view()
    std::size_t ahead_ = kBufferBytes;  // to be read at once
};

}  // namespace iwalk
