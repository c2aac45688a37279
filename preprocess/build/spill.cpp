#include "preprocess/build/spill.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace iwalk {
namespace {

Error spillError(const std::string& path, const char* what, std::uint64_t offset) {
    const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
    return fail("{}: cannot {} at byte {}: {}{}", path, what, offset, std::generic_category().message(errno),
                full ? "; free some space or build elsewhere" : "");
}

}  // namespace

Result<ChunkFile> ChunkFile::create(const std::string& path, std::size_t chunkBytes) {
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (descriptor < 0) return spillError(path, "create", 0);
    ::unlink(path.c_str());
    return ChunkFile(path, descriptor, chunkBytes);
}

ChunkFile::ChunkFile(ChunkFile&& other) noexcept {
    *this = std::move(other);
}

ChunkFile& ChunkFile::operator=(ChunkFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(chunkBytes_, other.chunkBytes_);
    std::swap(chunks_, other.chunks_);
    std::swap(free_, other.free_);
    return *this;
}

ChunkFile::~ChunkFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

Result<std::uint32_t> ChunkFile::write(std::span<const std::byte> chunk) {
    const std::uint32_t index = free_.empty() ? chunks_++ : free_.back();
    if (!free_.empty()) free_.pop_back();
    std::uint64_t offset = std::uint64_t{index} * chunkBytes_;
    while (!chunk.empty()) {
        const ssize_t put = ::pwrite(descriptor_, chunk.data(), chunk.size(), static_cast<off_t>(offset));
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return spillError(path_, "write", offset);
        offset += static_cast<std::uint64_t>(put);
        chunk = chunk.subspan(static_cast<std::size_t>(put));
    }
    return index;
}

Result<void> ChunkFile::read(std::uint32_t chunk, std::span<std::byte> out, std::size_t inChunk) const {
    std::uint64_t offset = std::uint64_t{chunk} * chunkBytes_ + inChunk;
    while (!out.empty()) {
        const ssize_t got = ::pread(descriptor_, out.data(), out.size(), static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got == 0) errno = EIO;  // we wrote it, so it must be there
        if (got <= 0) return spillError(path_, "read", offset);
        offset += static_cast<std::uint64_t>(got);
        out = out.subspan(static_cast<std::size_t>(got));
    }
    return {};
}

BinWriter::BinWriter(ChunkFile& file, std::size_t bins, std::size_t recordWords)
    : file_(file),
      recordWords_(recordWords),
      perChunk_(file.chunkBytes() / (4 * recordWords)),
      buffers_(bins),
      bins_(bins) {
    CHECK_OP(perChunk_, >=, 1u);
}

Result<void> BinWriter::makeRoom(std::size_t bin) {
    if (buffers_[bin].words.empty()) {
        buffers_[bin].words.resize(perChunk_ * recordWords_);
        return {};
    }
    return writeChunk(bin);
}

Result<void> BinWriter::writeChunk(std::size_t bin) {
    Buffer& buffer = buffers_[bin];
    const std::span<const std::uint32_t> words(buffer.words.data(), buffer.used * recordWords_);
    ASSIGN_OR_RETURN(const std::uint32_t chunk, file_.write(std::as_bytes(words)));
    bins_[bin].chunks.push_back(chunk);
    buffer.used = 0;
    return {};
}

Result<std::vector<Bin>> BinWriter::finish() {
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
        if (buffers_[bin].used > 0) RETURN_IF_ERROR(writeChunk(bin));
        buffers_[bin] = {};
    }
    return std::move(bins_);
}

BinReader::BinReader(ChunkFile& file, Bin bin, std::size_t recordWords)
    : file_(file),
      bin_(std::move(bin)),
      recordWords_(recordWords),
      perChunk_(file.chunkBytes() / (4 * recordWords)) {}

Result<void> BinReader::next(std::vector<std::uint32_t>& out) {
    CHECK_OP(bin_.count, >, 0u);
    const std::size_t records = static_cast<std::size_t>(std::min<std::uint64_t>(perChunk_, bin_.count));
    const std::size_t before = out.size();
    out.resize(before + records * recordWords_);
    const std::uint32_t chunk = bin_.chunks[nextChunk_++];
    RETURN_IF_ERROR(file_.read(chunk, std::as_writable_bytes(std::span(out).subspan(before))));
    file_.release(chunk);
    bin_.count -= records;
    return {};
}

}  // namespace iwalk
