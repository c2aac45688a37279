#pragma once

#include <memory>
#include <vector>

#include "server/frame/tile_pipeline.hpp"

namespace iwalk {

// The tiles that a rank draws, of one scene: what one has read, the others find.
class RankTiles {
  public:
    // `tiles`: of the wall, at least one. `costOfLooking`: of ConservativeDrawing. `threads`: of Scene.
    static Result<std::unique_ptr<RankTiles>> create(
        const Dataset& dataset, const Wall& wall, const std::vector<std::size_t>& tiles,
        const Settings& settings, double costOfLooking = ConservativeDrawing::kCostOfLooking,
        unsigned threads = 1);

    // The next frame is drawn with these; what is not live stays as it was.
    Result<void> apply(const Settings& settings);

    std::size_t size() const { return tiles_.size(); }
    TilePipeline& operator[](std::size_t i) { return *tiles_[i]; }

  private:
    std::unique_ptr<Scene> scene_;
    std::vector<std::unique_ptr<TilePipeline>> tiles_;
};

}  // namespace iwalk
