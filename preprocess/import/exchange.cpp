#include "preprocess/import/exchange.hpp"

#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>

#include "common/file.hpp"

namespace iwalk {

Result<void> ExchangeWriter::write(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t done = ::write(descriptor_, bytes.data(), bytes.size());
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) {
            return fail("cannot write its triangles ({}): {}", std::strerror(errno),
                        errno == EFBIG ? "they are too many for a file of its size" : "free some space");
        }
        bytes = bytes.subspan(static_cast<std::size_t>(done));
    }
    return {};
}

Result<void> ExchangeWriter::header(const ExchangeHeader& header) {
    return write(bytesOf(header));
}

Result<void> ExchangeWriter::block(std::span<const std::byte> bytes) {
    ++blocks_;
    RETURN_IF_ERROR(write(bytesOf(ExchangeBlock{bytes.size(), XXH3_64bits(bytes.data(), bytes.size())})));
    return write(bytes);
}

Result<void> ExchangeWriter::finish() {
    return write(bytesOf(ExchangeBlock{0, blocks_}));
}

Error ExchangeReader::damaged() const {
    return fail("{}: what iwalk-import made of it is damaged at byte {}: try again", name_, offset_);
}

Result<ExchangeHeader> ExchangeReader::header() {
    ExchangeHeader header;
    RETURN_IF_ERROR(file_.readAt(0, std::as_writable_bytes(std::span(&header, 1))));
    if (header.magic != ExchangeHeader::kMagic) return damaged();
    offset_ = sizeof header;
    return header;
}

Result<std::span<const std::byte>> ExchangeReader::block() {
    ExchangeBlock block;
    RETURN_IF_ERROR(file_.readAt(offset_, std::as_writable_bytes(std::span(&block, 1))));
    if (block.bytes > kMostBlockBytes) return damaged();
    bytes_.resize(static_cast<std::size_t>(block.bytes));
    if (block.bytes == 0) {
        if (block.checksum != blocks_) return damaged();
        return std::span<const std::byte>();
    }
    RETURN_IF_ERROR(file_.readAt(offset_ + sizeof block, bytes_));
    if (XXH3_64bits(bytes_.data(), bytes_.size()) != block.checksum) return damaged();
    offset_ += sizeof block + block.bytes;
    ++blocks_;
    return std::span<const std::byte>(bytes_);
}

}  // namespace iwalk
