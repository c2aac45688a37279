#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

// A file to read at any place, from any thread. Behind an interface so that tests can inject faults.
class RandomAccessFile {
  public:
    virtual ~RandomAccessFile() = default;
    // Fills all of `out` from byte `offset` on, or fails naming the file and the offset (end of file
    // included).
    virtual Result<void> readAt(std::uint64_t offset, std::span<std::byte> out) const = 0;
    virtual std::uint64_t size() const = 0;  // bytes
};

Result<std::unique_ptr<RandomAccessFile>> openForReading(const std::string& path);

// A file written front to back through a buffer. Nothing is promised to be on disk before sync().
class OutputFile {
  public:
    // Creates or truncates `path`.
    static Result<OutputFile> create(const std::string& path);
    OutputFile(OutputFile&& other) noexcept;
    OutputFile& operator=(OutputFile&& other) noexcept;
    ~OutputFile();

    Result<void> write(std::span<const std::byte> bytes);
    // Hands everything to the system, so that others can read it.
    Result<void> flush();
    // Replaces bytes written before, from byte `offset` on: a header whose counts are known late.
    Result<void> overwrite(std::uint64_t offset, std::span<const std::byte> bytes);
    // Flushes, fsyncs and closes; fails with the system's reason (a full disk, for instance).
    Result<void> sync();
    std::uint64_t size() const { return size_; }  // bytes written so far
    const std::string& path() const { return path_; }

  private:
    OutputFile(std::string path, int descriptor);

    std::string path_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
    std::vector<std::byte> buffer_;
};

// The whole file; fails when it is larger than `limit` bytes.
Result<std::string> readWholeFile(const std::string& path, std::uint64_t limit);

// Writes beside `path`, fsyncs, and renames over it: readers see the old file or the new one, never a part.
Result<void> replaceFile(const std::string& path, std::string_view contents);

// Fsyncs a directory, so that the names in it last.
Result<void> syncDirectory(const std::string& path);

template <class T>
std::span<const std::byte> bytesOf(std::span<const T> values) {
    return std::as_bytes(values);
}
template <class T>
std::span<const std::byte> bytesOf(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(std::span<const T, 1>(&value, 1));
}

}  // namespace iwalk
