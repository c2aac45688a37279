#include "client/capture.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <span>
#include <string_view>
#include <system_error>

namespace iwalk::client {
namespace {

namespace fs = std::filesystem;

Result<void> makeDirectory(const std::string& directory) {
    std::error_code error;
    fs::create_directories(directory, error);
    if (error) return fail("cannot make the directory {}: {}", directory, error.message());
    return {};
}

// Under another name first: a picture that is there is whole. No fsync, unlike replaceFile(): a picture can
// be made again, and waiting for the disk 17 times a frame would be most of a capture's time.
Result<void> writePicture(const std::string& path, std::span<const std::byte> bytes) {
    const std::string part = path + ".part";
    std::FILE* file = std::fopen(part.c_str(), "wb");
    if (!file) return fail("cannot write {}: {}", part, std::strerror(errno));
    errno = 0;
    const bool wrote = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    const int writeError = errno;
    const bool closed = std::fclose(file) == 0;
    if (!wrote || !closed || std::rename(part.c_str(), path.c_str()) != 0) {
        const int reason = wrote ? errno : writeError;
        std::remove(part.c_str());
        return fail("cannot write {}: {}", path, std::strerror(reason));
    }
    return {};
}

template <class T>
Result<void> checkSize(const Image<T>& image, const protocol::TileInfo& tile, const std::string& name) {
    if (image.width == tile.width && image.height == tile.height) return {};
    return fail("the server sent {} of {} x {} px; the tile has {} x {}", name, image.width, image.height,
                tile.width, tile.height);
}

void copyInto(ColorImage& wall, const ColorImage& tile, int x, int y) {
    const std::size_t rowBytes =
        static_cast<std::size_t>(tile.width) * static_cast<std::size_t>(tile.channels);
    for (int row = 0; row < tile.height; ++row) std::copy_n(tile.at(0, row), rowBytes, wall.at(x, y + row));
}

}  // namespace

Result<std::unique_ptr<Capture>> Capture::create(const std::string& directory,
                                                 const protocol::Welcome& welcome) {
    RETURN_IF_ERROR(makeDirectory(directory));
    return std::unique_ptr<Capture>(new Capture(directory, welcome));
}

Capture::Capture(std::string directory, const protocol::Welcome& welcome)
    : directory_(std::move(directory)), welcome_(welcome), worker_([this] { work(); }) {}

Capture::~Capture() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    worker_.join();
}

void Capture::add(std::size_t frame, protocol::TileImage image) {
    const std::lock_guard lock(mutex_);
    if (error_) return;
    jobs_.push_back({frame, std::move(image)});
    changed_.notify_all();
}

std::size_t Capture::backlog() const {
    const std::lock_guard lock(mutex_);
    return jobs_.size();
}

Result<void> Capture::status() const {
    const std::lock_guard lock(mutex_);
    return error_ ? Result<void>(*error_) : Result<void>();
}

Result<void> Capture::finish() {
    {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return jobs_.empty() || error_; });
    }
    return status();
}

void Capture::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
        if (stop_) return;
        // Stays in the queue while it is worked on; add() at the other end of a deque does not move it.
        const Job& job = jobs_.front();
        lock.unlock();
        const Result<void> done = tryWrite(job);
        lock.lock();
        jobs_.pop_front();
        if (!done) {
            error_ = done.error();
            jobs_.clear();
        }
        changed_.notify_all();
    }
}

// Walls are large: memory may run out, and a thread must not throw.
Result<void> Capture::tryWrite(const Job& job) {
    try {
        return write(job);
    } catch (const std::exception& error) {
        return fail("cannot capture frame {}: {}", job.frame, error.what());
    }
}

Result<void> Capture::write(const Job& job) {
    const protocol::TileInfo& tile = welcome_.tiles[job.image.tile];
    const std::string directory = fmt::format("{}/frame-{:06}", directory_, job.frame);
    const bool color = job.image.kind == protocol::ImageKind::png;
    const std::string name = tile.name + (color ? ".png" : ".exr");
    RETURN_IF_ERROR(makeDirectory(directory));
    RETURN_IF_ERROR(writePicture(directory + "/" + name, job.image.bytes));
    if (color) return stitch(job, directory, name);
    ASSIGN_OR_RETURN(const DepthImage depth, decodeExr(job.image.bytes, name));
    return checkSize(depth, tile, name);
}

Result<void> Capture::stitch(const Job& job, const std::string& directory, const std::string& name) {
    const protocol::TileInfo& tile = welcome_.tiles[job.image.tile];
    ASSIGN_OR_RETURN(const ColorImage picture, decodePng(job.image.bytes, name));
    RETURN_IF_ERROR(checkSize(picture, tile, name));
    if (welcome_.wallWidth == 0 || welcome_.wallHeight == 0) return {};  // free screens: no common picture

    Stitching& frame = stitching_[job.frame];
    if (frame.tiles == 0) frame.wall = ColorImage(welcome_.wallWidth, welcome_.wallHeight, 3);
    copyInto(frame.wall, picture, tile.x, tile.y);
    if (++frame.tiles < welcome_.tiles.size()) return {};

    const ColorImage wall = std::move(frame.wall);
    stitching_.erase(job.frame);
    ASSIGN_OR_RETURN(const std::vector<std::byte> png, encodePng(wall));
    return writePicture(directory + "/wall.png", png);
}

}  // namespace iwalk::client
