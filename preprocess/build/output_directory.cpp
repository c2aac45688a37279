#include "preprocess/build/output_directory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "common/file.hpp"

namespace iwalk {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTemporary = ".iwalk-build";
constexpr const char* kLock = ".iwalk-lock";

std::string reason(int code) {
    const bool full = code == ENOSPC || code == EDQUOT;
    return std::generic_category().message(code) + (full ? "; free some space or build elsewhere" : "");
}

// G of `pages-G.bin` and `hierarchy-G.bin`.
std::optional<std::uint32_t> generationOf(const std::string& name) {
    for (const std::string_view prefix : {"pages-", "hierarchy-"}) {
        if (!name.starts_with(prefix) || !name.ends_with(".bin")) continue;
        const char* const begin = name.data() + prefix.size();
        const char* const end = name.data() + name.size() - 4;
        std::uint32_t generation = 0;
        const auto [stop, error] = std::from_chars(begin, end, generation);
        if (error == std::errc() && stop == end && begin != end) return generation;
    }
    return std::nullopt;
}

bool isOurScratch(const std::string& name) {
    return name == kTemporary || name == kLock || name == std::string(kManifestName) + ".new";
}

Result<std::vector<std::string>> namesIn(const std::string& path) {
    std::error_code error;
    std::vector<std::string> names;
    for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
        names.push_back(entry->path().filename().string());
    }
    if (error) return fail("{}: cannot list: {}", path, error.message());
    return names;
}

}  // namespace

Result<OutputDirectory> OutputDirectory::open(const std::string& path) {
    OutputDirectory directory;
    directory.path_ = path;
    struct stat status {};
    if (::mkdir(path.c_str(), 0777) == 0) {
        directory.made_ = true;
    } else if (errno != EEXIST) {
        return fail("{}: cannot make the directory: {}", path, reason(errno));
    } else if (::stat(path.c_str(), &status) != 0 || !S_ISDIR(status.st_mode)) {
        return fail("{}: exists and is not a directory: choose another output", path);
    }
    RETURN_IF_ERROR(directory.inspect());
    RETURN_IF_ERROR(directory.lock());
    RETURN_IF_ERROR(directory.inspect());  // another may have committed before it gave the lock free
    directory.removeLeftovers(nullptr);
    if (::mkdir(directory.temporaryDirectory().c_str(), 0777) != 0) {
        return fail("{}: cannot make the directory: {}", directory.temporaryDirectory(), reason(errno));
    }
    return directory;
}

OutputDirectory::OutputDirectory(OutputDirectory&& other) noexcept
    : path_(std::move(other.path_)),
      lock_(std::exchange(other.lock_, -1)),
      made_(other.made_),
      committed_(other.committed_),
      generation_(other.generation_) {}

OutputDirectory::~OutputDirectory() {
    if (lock_ < 0) {  // moved from, or somebody else's; a directory that we made is empty and goes
        if (made_ && !path_.empty()) ::rmdir(path_.c_str());
        return;
    }
    if (!committed_) removeLeftovers(nullptr);
    ::unlink((path_ + "/" + kLock).c_str());
    if (made_ && !committed_) ::rmdir(path_.c_str());
    ::close(lock_);
}

std::string OutputDirectory::temporaryDirectory() const {
    return path_ + "/" + kTemporary;
}
std::string OutputDirectory::temporary(const std::string& name) const {
    return temporaryDirectory() + "/" + name;
}

Result<void> OutputDirectory::inspect() {
    ASSIGN_OR_RETURN(const std::vector<std::string> names, namesIn(path_));
    const auto has = [&](const char* name) { return std::ranges::find(names, name) != names.end(); };
    const bool killedBuild = has(kTemporary) || has(kLock);
    for (const std::string& name : names) {
        const std::optional<std::uint32_t> generation = generationOf(name);
        if (generation) generation_ = std::max(generation_, *generation + 1);
        const bool ours = has(kManifestName) || isOurScratch(name) || (killedBuild && generation);
        if (!ours) {
            return fail("{}: has files but no {}: not a dataset, so it is left alone; choose another output",
                        path_, kManifestName);
        }
    }
    return {};
}

Result<void> OutputDirectory::lock() {
    const std::string path = path_ + "/" + kLock;
    for (;;) {
        const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor < 0) return fail("{}: cannot create: {}", path, reason(errno));
        if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
            const int code = errno;
            ::close(descriptor);
            if (code == EWOULDBLOCK) return fail("{}: another build is at work here: wait for it", path_);
            return fail("{}: cannot lock: {}", path, reason(code));
        }
        // Its last owner may have removed the file between our opening and our locking it.
        struct stat ours {
        }, there{};
        const bool same = ::fstat(descriptor, &ours) == 0 && ::stat(path.c_str(), &there) == 0 &&
                          ours.st_ino == there.st_ino && ours.st_dev == there.st_dev;
        if (same) {
            lock_ = descriptor;
            return {};
        }
        ::close(descriptor);
    }
}

// Removes what no manifest names: the temporary directory, and generations other than that of the manifest
// given, or of the one that is there. Garbage that cannot be removed does no harm, so errors are left to the
// next build.
void OutputDirectory::removeLeftovers(const Manifest* keep) const {
    std::error_code ignored;
    fs::remove_all(temporaryDirectory(), ignored);
    ::unlink((path_ + "/" + kManifestName + ".new").c_str());
    std::optional<Manifest> there;
    const bool hasManifest = fs::exists(path_ + "/" + kManifestName, ignored);
    if (keep == nullptr && hasManifest) {
        auto loaded = loadManifest(path_);
        if (!loaded) return;  // damaged or of another version: not ours to tidy
        there = std::move(*loaded);
        keep = &*there;
    }
    std::set<std::string> named;
    if (keep != nullptr) {
        named.insert(keep->hierarchy.name);
        for (const DatasetFile& file : keep->pageFiles) named.insert(file.name);
    }
    const auto names = namesIn(path_);
    if (!names) return;
    for (const std::string& name : *names) {
        if (generationOf(name) && !named.contains(name)) ::unlink((path_ + "/" + name).c_str());
    }
}

Result<void> OutputDirectory::moveInto(const std::string& name) {
    const std::string to = path_ + "/" + name;
    if (::rename(temporary(name).c_str(), to.c_str()) != 0)
        return fail("{}: cannot create: {}", to, reason(errno));
    return {};
}

Result<void> OutputDirectory::commit(const Manifest& manifest) {
    RETURN_IF_ERROR(moveInto(manifest.hierarchy.name));
    for (const DatasetFile& file : manifest.pageFiles) {
        if (generationOf(file.name) == generation_) RETURN_IF_ERROR(moveInto(file.name));
    }
    RETURN_IF_ERROR(syncDirectory(path_));
    RETURN_IF_ERROR(saveManifest(path_, manifest));
    committed_ = true;
    removeLeftovers(&manifest);
    return {};
}

}  // namespace iwalk
