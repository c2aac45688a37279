#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/file.hpp"

namespace iwalk {

// A part of a text file, cut where its parser wants it.
class TextBlock {
  public:
    // Reads `want` bytes from `offset` on, or what the file has of them.
    Result<void> read(const RandomAccessFile& file, std::uint64_t offset, std::size_t want);
    // Leaves the first `size` bytes.
    void cut(std::size_t size);

    // Behind it stands a '\n', so that a number needs no check for the end.
    std::string_view text() const { return {bytes_.data(), size_}; }
    std::uint64_t offset() const { return offset_; }  // of its first byte in the file
    std::uint64_t end() const { return offset_ + size_; }

  private:
    std::vector<char> bytes_ = std::vector<char>(1, '\n');
    std::size_t size_ = 0;
    std::uint64_t offset_ = 0;
};

}  // namespace iwalk
