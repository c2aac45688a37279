#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/image.hpp"
#include "common/protocol.hpp"

namespace iwalk {

// One tile's pixels of a finished frame and where they are to go.
struct TilePicture {
    std::uint64_t frame = 0, sequence = 0;
    std::uint32_t tile = 0;  // as in protocol::TileImage
    std::string file;        // PNG file to write; empty: none
    bool capture = false;    // hand the PNG (and EXR) to encoded()
    ColorImage color;
    std::optional<DepthImage> depth;
};

// Of --present file.
std::string tileFile(const std::string& directory, std::uint64_t frame, const std::string& tile);

// Compresses and writes pictures on a thread of its own, so that drawing goes on. Holds at most kMaxWaiting
// pictures; put() waits when there are more.
class TileWriter {
  public:
    static constexpr std::size_t kMaxWaiting = 3;

    TileWriter();
    ~TileWriter();  // finishes what was put
    TileWriter(const TileWriter&) = delete;
    TileWriter& operator=(const TileWriter&) = delete;

    void put(TilePicture picture);
    // The captures compressed since the last call; never waits.
    std::vector<protocol::TileImage> encoded();

  private:
    void run();
    void process(const TilePicture& picture);
    void writeFile(const std::string& path, const std::vector<std::byte>& bytes);
    void hand(protocol::TileImage tile);

    std::mutex mutex_;  // guards all below
    std::condition_variable changed_;
    std::deque<TilePicture> waiting_;
    std::vector<protocol::TileImage> encoded_;
    bool stop_ = false, reported_ = false;
    std::thread thread_;
};

}  // namespace iwalk
