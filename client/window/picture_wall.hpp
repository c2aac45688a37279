#pragma once

#include <cstdint>
#include <map>

#include "client/fly/flight.hpp"

namespace iwalk::client {

// The preview: small pictures of the tiles where they are on the wall, behind all else in the window.
class PictureWall {
  public:
    // With the GL context current. What is no picture is left out.
    void take(const protocol::TileImage& preview, const WallState& wall);
    void draw(const Flight& flight);
    void clear();

  private:
    struct Picture {
        std::uint32_t texture = 0;  // GL name
        std::size_t pixels = 0;
    };
    std::map<std::uint32_t, Picture> pictures_;    // by tile
    std::size_t pixels_ = 0;                       // of all
    std::shared_ptr<const protocol::Welcome> of_;  // the wall that they are of
};

}  // namespace iwalk::client
