#include "common/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace iwalk {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{256} << 10;
constexpr std::size_t kReadChunk = std::size_t{64} << 10;

constexpr const char* kFreeSpace = "; free some space or write elsewhere";

std::string reason(int code) {
    return std::generic_category().message(code);
}

Error writeError(const std::string& path, std::uint64_t offset, int code) {
    const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
    return fail("{}: cannot write at byte {}: {}{}", path, offset, reason(code), full ? kFreeSpace : "");
}

// Closes on every way out.
struct Descriptor {
    int value = -1;
    explicit Descriptor(int descriptor) : value(descriptor) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (value >= 0) ::close(value);
    }
};

class PosixFile final : public RandomAccessFile {
  public:
    PosixFile(std::string path, int descriptor, std::uint64_t size)
        : path_(std::move(path)), descriptor_(descriptor), size_(size) {}

    Result<void> readAt(std::uint64_t offset, std::span<std::byte> out) const override {
        while (!out.empty()) {
            const ssize_t got =
                ::pread(descriptor_.value, out.data(), out.size(), static_cast<off_t>(offset));
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) return fail("{}: cannot read at byte {}: {}", path_, offset, reason(errno));
            if (got == 0) return fail("{}: ends at byte {}, {} bytes short", path_, offset, out.size());
            offset += static_cast<std::uint64_t>(got);
            out = out.subspan(static_cast<std::size_t>(got));
        }
        return {};
    }
    std::uint64_t size() const override { return size_; }

  private:
    std::string path_;
    Descriptor descriptor_;
    std::uint64_t size_;
};

// Writes all of `bytes` at the descriptor's place; `offset` is for the message.
Result<void> writeAll(int descriptor, const std::string& path, std::uint64_t offset,
                      std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t put = ::write(descriptor, bytes.data(), bytes.size());
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return writeError(path, offset, errno);
        offset += static_cast<std::uint64_t>(put);
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
    return {};
}

}  // namespace

Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return fail("{}: cannot open: {}", path, reason(errno));
    struct stat status {};
    const bool known = ::fstat(descriptor, &status) == 0;
    if (!known || !S_ISREG(status.st_mode)) {
        const Error error =
            known ? fail("{}: not a regular file", path) : fail("{}: {}", path, reason(errno));
        ::close(descriptor);
        return error;
    }
    return std::unique_ptr<RandomAccessFile>(
        std::make_unique<PosixFile>(path, descriptor, static_cast<std::uint64_t>(status.st_size)));
}

Result<OutputFile> OutputFile::create(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor < 0) {
        const bool full = errno == ENOSPC || errno == EDQUOT;
        return fail("{}: cannot create: {}{}", path, reason(errno), full ? kFreeSpace : "");
    }
    return OutputFile(path, descriptor);
}

OutputFile::OutputFile(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

OutputFile::OutputFile(OutputFile&& other) noexcept {
    *this = std::move(other);
}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(size_, other.size_);
    std::swap(buffer_, other.buffer_);
    return *this;
}

OutputFile::~OutputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> OutputFile::write(std::span<const std::byte> bytes) {
    if (buffer_.size() + bytes.size() > kBufferBytes) RETURN_IF_ERROR(flush());
    if (bytes.size() >= kBufferBytes) {
        RETURN_IF_ERROR(writeAll(descriptor_, path_, size_, bytes));
    } else {
        buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    }
    size_ += bytes.size();
    return {};
}

Result<void> OutputFile::overwrite(std::uint64_t offset, std::span<const std::byte> bytes) {
    CHECK_OP(offset + bytes.size(), <=, size_);
    RETURN_IF_ERROR(flush());
    while (!bytes.empty()) {
        const ssize_t put = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (put < 0 && errno == EINTR) continue;
        if (put < 0) return writeError(path_, offset, errno);
        offset += static_cast<std::uint64_t>(put);
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
    return {};
}

Result<void> OutputFile::flush() {
    RETURN_IF_ERROR(writeAll(descriptor_, path_, size_ - buffer_.size(), buffer_));
    buffer_.clear();
    return {};
}

Result<void> OutputFile::sync() {
    RETURN_IF_ERROR(flush());
    if (::fsync(descriptor_) != 0) return writeError(path_, size_, errno);
    if (::close(std::exchange(descriptor_, -1)) != 0) return writeError(path_, size_, errno);
    return {};
}

Result<std::string> readWholeFile(const std::string& path, std::uint64_t limit) {
    // Read rather than sized, so that pipes work too.
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.value < 0) return fail("{}: cannot open: {}", path, reason(errno));
    std::string text;
    for (;;) {
        const std::size_t before = text.size();
        text.resize(before + kReadChunk);
        const ssize_t got = ::read(file.value, text.data() + before, kReadChunk);
        const int code = errno;
        text.resize(before + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
        if (got < 0 && code == EINTR) continue;
        if (got < 0) return fail("{}: cannot read at byte {}: {}", path, before, reason(code));
        if (text.size() > limit)
            return fail("{}: larger than {} bytes, which is the limit here", path, limit);
        if (got == 0) return text;
    }
}

Result<void> replaceFile(const std::string& path, std::string_view contents) {
    const std::string beside = path + ".new";
    const auto written = [&]() -> Result<void> {
        ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(beside));
        RETURN_IF_ERROR(file.write(std::as_bytes(std::span(contents))));
        RETURN_IF_ERROR(file.sync());
        if (::rename(beside.c_str(), path.c_str()) != 0)
            return fail("{}: cannot replace: {}", path, reason(errno));
        return {};
    }();
    if (!written) {
        ::unlink(beside.c_str());
        return written;
    }
    const std::string parent = std::filesystem::path(path).parent_path().string();
    return syncDirectory(parent.empty() ? "." : parent);
}

Result<void> syncDirectory(const std::string& path) {
    const Descriptor directory(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (directory.value < 0) return fail("{}: cannot open the directory: {}", path, reason(errno));
    if (::fsync(directory.value) != 0) return fail("{}: cannot sync the directory: {}", path, reason(errno));
    return {};
}

}  // namespace iwalk
