#include "preprocess/import/spill_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace iwalk {

Result<std::unique_ptr<SpillFile>> SpillFile::create(const std::string& directory) {
    std::string path = directory + "/iwalk-spill-XXXXXX";
    const int descriptor = ::mkostemp(path.data(), O_CLOEXEC);
    if (descriptor < 0) {
        return fail("{}: cannot make a spill file ({}): {}", directory, std::strerror(errno),
                    errno == ENOSPC ? "free some space there" : "give a directory that can be written");
    }
    ::unlink(path.c_str());
    return std::unique_ptr<SpillFile>(new SpillFile(directory, descriptor));
}

SpillFile::~SpillFile() {
    ::close(descriptor_);
}

Result<void> SpillFile::writeAt(std::uint64_t offset, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t done = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) {
            return fail(
                "{}: cannot write the spill file at byte {} ({}): free some space there, or give more memory",
                directory_, offset, std::strerror(errno));
        }
        bytes = bytes.subspan(static_cast<std::size_t>(done));
        offset += static_cast<std::uint64_t>(done);
    }
    return {};
}

Result<void> SpillFile::readAt(std::uint64_t offset, std::span<std::byte> bytes) const {
    while (!bytes.empty()) {
        const ssize_t done = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) {
            return fail("{}: cannot read the spill file at byte {} ({})", directory_, offset,
                        done < 0 ? std::strerror(errno) : "it is shorter than what was written");
        }
        bytes = bytes.subspan(static_cast<std::size_t>(done));
        offset += static_cast<std::uint64_t>(done);
    }
    return {};
}

}  // namespace iwalk
