#include "server/present/tile_writer.hpp"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <string_view>
#include <system_error>

#include "common/file.hpp"

namespace iwalk {

std::string tileFile(const std::string& directory, std::uint64_t frame, const std::string& tile) {
    return fmt::format("{}/frame-{:06}/{}.png", directory, frame, tile);
}

TileWriter::TileWriter() : thread_([this] { run(); }) {}

TileWriter::~TileWriter() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void TileWriter::put(TilePicture picture) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_.size() < kMaxWaiting; });
    waiting_.push_back(std::move(picture));
    changed_.notify_all();
}

std::vector<protocol::TileImage> TileWriter::encoded() {
    const std::lock_guard lock(mutex_);
    return std::exchange(encoded_, {});
}

void TileWriter::run() {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
        if (waiting_.empty()) return;
        const TilePicture picture = std::move(waiting_.front());
        waiting_.pop_front();
        changed_.notify_all();
        lock.unlock();
        process(picture);
        lock.lock();
    }
}

void TileWriter::process(const TilePicture& picture) {
    Result<std::vector<std::byte>> png = encodePng(picture.color);
    if (!png) return spdlog::error("frame {}: {}", picture.frame, png.error().message);
    if (!picture.file.empty()) writeFile(picture.file, *png);
    if (picture.capture)
        hand({picture.sequence, picture.tile, protocol::ImageKind::png, std::move(png).value()});
    if (!picture.depth) return;
    Result<std::vector<std::byte>> exr = encodeExr(*picture.depth);
    if (!exr) return spdlog::error("frame {}: {}", picture.frame, exr.error().message);
    hand({picture.sequence, picture.tile, protocol::ImageKind::exr, std::move(exr).value()});
}

// A picture that cannot be written costs the picture, not the wall; it is said once.
void TileWriter::writeFile(const std::string& path, const std::vector<std::byte>& bytes) {
    std::error_code ignored;
    std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ignored);
    const std::string_view contents(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const Result<void> written = replaceFile(path, contents);
    if (!written && !std::exchange(reported_, true))
        spdlog::error("{}; the wall goes on without its pictures", written.error().message);
}

void TileWriter::hand(protocol::TileImage tile) {
    const std::lock_guard lock(mutex_);
    encoded_.push_back(std::move(tile));
}

}  // namespace iwalk
