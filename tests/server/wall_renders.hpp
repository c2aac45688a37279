#pragma once

#include <string>
#include <vector>

#include "common/camera_path.hpp"
#include "server/frame/tile_pipeline.hpp"
#include "tests/tools/compare.hpp"

namespace iwalk::tools {

// A wall of columns x rows tiles that cut width x height px as evenly as whole pixels allow, no bezels.
Wall wallOf(int width, int height, int columns, int rows);

// Draws the wall tile after tile in this process, without MPI and sockets, and stitches it. Needs a current
// GL context.
class WallRenders {
  public:
    WallRenders(const Dataset& dataset, Settings settings) : dataset_(dataset), settings_(settings) {}
    // Colour and eye-space depth of the whole wall. Ends the program on errors.
    Picture draw(const Wall& wall, const Camera& camera);
    // Sums over the tiles of the last draw().
    const protocol::TileStats& stats() const { return stats_; }

  private:
    const Dataset& dataset_;
    const Settings settings_;
    protocol::TileStats stats_;
};

}  // namespace iwalk::tools
