#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/image.hpp"
#include "common/protocol.hpp"
#include "common/result.hpp"

namespace iwalk::client {

// Writes captured tiles as they come, DIR/frame-000000/TILE.png and TILE.exr, and stitches
// DIR/frame-000000/wall.png when the last tile of a frame is there. Decoding, stitching and writing are on a
// thread of its own, so that the socket is read on meanwhile. Files appear under their names only when they
// are whole.
class Capture {
  public:
    // Makes `directory`. `welcome` has passed checkWall().
    static Result<std::unique_ptr<Capture>> create(const std::string& directory,
                                                   const protocol::Welcome& welcome);
    ~Capture();  // waits for what it is doing, drops the rest

    // `frame` is the index in the path; image.tile is one of the wall's.
    void add(std::size_t frame, protocol::TileImage image);
    // Images added and not written yet; who adds faster than the disk takes looks here.
    std::size_t backlog() const;
    // The first error, at any time.
    Result<void> status() const;
    // Waits until all is written.
    Result<void> finish();

  private:
    struct Job {
        std::size_t frame = 0;
        protocol::TileImage image;
    };
    struct Stitching {
        ColorImage wall;
        std::size_t tiles = 0;  // in it so far
    };

    Capture(std::string directory, const protocol::Welcome& welcome);
    void work();
    Result<void> tryWrite(const Job& job);
    Result<void> write(const Job& job);
    Result<void> stitch(const Job& job, const std::string& directory, const std::string& name);

    const std::string directory_;
    const protocol::Welcome welcome_;
    std::map<std::size_t, Stitching> stitching_;  // the worker's

    mutable std::mutex mutex_;  // guards all below
    std::condition_variable changed_;
    std::deque<Job> jobs_;  // the first one is being worked on
    std::optional<Error> error_;
    bool stop_ = false;

    std::thread worker_;
};

}  // namespace iwalk::client
