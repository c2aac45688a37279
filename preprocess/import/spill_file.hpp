#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "common/result.hpp"

namespace iwalk {

// A nameless temporary file: unlinked as soon as it is open, so that even a kill leaves nothing behind.
class SpillFile {
  public:
    static Result<std::unique_ptr<SpillFile>> create(const std::string& directory);
    ~SpillFile();
    SpillFile(const SpillFile&) = delete;
    SpillFile& operator=(const SpillFile&) = delete;

    Result<void> writeAt(std::uint64_t offset, std::span<const std::byte> bytes);
    Result<void> readAt(std::uint64_t offset, std::span<std::byte> bytes) const;
    int descriptor() const { return descriptor_; }  // for another program to write to

  private:
    SpillFile(std::string directory, int descriptor)
        : directory_(std::move(directory)), descriptor_(descriptor) {}
    std::string directory_;  // for messages
    int descriptor_;
};

}  // namespace iwalk
