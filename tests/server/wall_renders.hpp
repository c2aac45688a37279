#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/camera_path.hpp"
#include "server/frame/rank_tiles.hpp"
#include "tests/tools/compare.hpp"

namespace iwalk::tools {

// A wall of columns x rows tiles that cut width x height px as evenly as whole pixels allow, no bezels.
Wall wallOf(int width, int height, int columns, int rows);

// The servers of a wall in this process, without MPI and sockets: what they remember from frame to frame,
// they remember here. Needs a current GL context. Errors end the program.
class WallServers {
  public:
    // Both are kept by reference. `costOfLooking`: of ConservativeDrawing. `ranks`: how many share the tiles;
    // 0: one for each. `threads`: of visibility, of each rank.
    WallServers(const Dataset& dataset, const Wall& wall, const Settings& settings,
                double costOfLooking = ConservativeDrawing::kCostOfLooking, std::size_t ranks = 0,
                unsigned threads = 1);
    // Draws tile after tile; colour and eye-space depth of the whole wall.
    Picture draw(const Camera& camera);
    // The same without pictures, as when nobody captures.
    void drawOnly(const Camera& camera);
    // Sums over the tiles of the last time.
    const protocol::TileStats& stats() const { return stats_; }
    // Of each tile.
    const std::vector<protocol::TileStats>& tileStats() const { return tileStats_; }

  private:
    void drawTiles(const Camera& camera, std::uint32_t flags);

    const Wall& wall_;
    const double near_;  // model units
    std::vector<std::unique_ptr<RankTiles>> ranks_;
    std::vector<TilePipeline*> tiles_;  // of all ranks
    protocol::TileStats stats_;
    std::vector<protocol::TileStats> tileStats_;
};

// Each picture by servers that have just begun.
class WallRenders {
  public:
    WallRenders(const Dataset& dataset, Settings settings) : dataset_(dataset), settings_(settings) {}
    Picture draw(const Wall& wall, const Camera& camera);
    const protocol::TileStats& stats() const { return stats_; }

  private:
    const Dataset& dataset_;
    const Settings settings_;
    protocol::TileStats stats_;
};

}  // namespace iwalk::tools
