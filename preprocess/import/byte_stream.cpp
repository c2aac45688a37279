#include "preprocess/import/byte_stream.hpp"

#include <algorithm>
#include <cstring>

namespace iwalk {
namespace {
// Who goes elsewhere may want little there, and go on soon.
constexpr std::size_t kSeekBytes = std::size_t{4} << 10;
}  // namespace

void ByteStream::seek(std::uint64_t offset) {
    const std::uint64_t first = loaded_ - size_;  // in the buffer
    if (offset >= first && offset <= loaded_) {
        begin_ = static_cast<std::size_t>(offset - first);
        return;
    }
    begin_ = size_ = 0;
    loaded_ = offset;
    ahead_ = kSeekBytes;
    buffer_[0] = '\n';
}

Result<void> ByteStream::refill(std::size_t want) {
    const std::size_t kept = size_ - begin_;
    std::memmove(buffer_.data(), buffer_.data() + begin_, kept);
    begin_ = 0, size_ = kept;

    const std::size_t room = std::max(want, ahead_);
    ahead_ = std::min(2 * ahead_, kBufferBytes);
    if (buffer_.size() < room + 1) buffer_.resize(room + 1);
    const std::uint64_t left = loaded_ < file_.size() ? file_.size() - loaded_ : 0;
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(room - kept, left));
    if (count > 0) {
        RETURN_IF_ERROR(
            file_.readAt(loaded_, std::as_writable_bytes(std::span(buffer_.data() + kept, count))));
    }
    loaded_ += count, size_ += count;
    buffer_[size_] = '\n';
    return {};
}

}  // namespace iwalk
