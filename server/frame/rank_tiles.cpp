#include "server/frame/rank_tiles.hpp"

namespace iwalk {

Result<std::unique_ptr<RankTiles>> RankTiles::create(const Dataset& dataset, const Wall& wall,
                                                     const std::vector<std::size_t>& tiles,
                                                     const Settings& settings, double costOfLooking,
                                                     unsigned threads) {
    std::vector<PixelRect> rects;
    for (const std::size_t tile : tiles) rects.push_back(wall.tiles[tile].onScreen);
    auto rank = std::make_unique<RankTiles>();
    ASSIGN_OR_RETURN(rank->scene_, Scene::create(dataset, rects, settings, threads));
    for (const std::size_t tile : tiles) {
        ASSIGN_OR_RETURN(std::unique_ptr<TilePipeline> pipeline,
                         TilePipeline::create(*rank->scene_, wall, tile, settings, costOfLooking));
        rank->tiles_.push_back(std::move(pipeline));
    }
    return rank;
}

Result<void> RankTiles::apply(const Settings& settings) {
    RETURN_IF_ERROR(scene_->apply(settings));
    for (const std::unique_ptr<TilePipeline>& tile : tiles_) tile->apply(settings);
    return {};
}

}  // namespace iwalk
