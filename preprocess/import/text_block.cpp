#include "preprocess/import/text_block.hpp"

#include <algorithm>

namespace iwalk {

Result<void> TextBlock::read(const RandomAccessFile& file, std::uint64_t offset, std::size_t want) {
    const std::uint64_t left = file.size() - std::min(file.size(), offset);
    const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(want, left));
    if (bytes_.size() < size + 1) bytes_.resize(size + 1);
    offset_ = offset;
    RETURN_IF_ERROR(file.readAt(offset, std::as_writable_bytes(std::span(bytes_.data(), size))));
    cut(size);
    return {};
}

void TextBlock::cut(std::size_t size) {
    size_ = size;
    bytes_[size] = '\n';
}

}  // namespace iwalk
