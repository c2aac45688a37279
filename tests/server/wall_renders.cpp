#include "tests/server/wall_renders.hpp"

#include <algorithm>

#include "common/check.hpp"
#include "server/wall/assign.hpp"

namespace iwalk::tools {
namespace {

FrameState stateOf(const Camera& camera, double near, std::uint32_t flags) {
    FrameState state;
    const auto copy = [](const glm::dvec3& from, double(&to)[3]) {
        to[0] = from.x, to[1] = from.y, to[2] = from.z;
    };
    copy(camera.eye, state.eye);
    copy(camera.target, state.target);
    copy(camera.up, state.up);
    state.fovY = camera.fovY;
    state.near = near;
    state.flags = flags;
    return state;
}

template <class T>
void paste(const Image<T>& tile, const PixelRect& rect, Image<T>& wall) {
    CHECK_OP(tile.width, ==, rect.width);
    for (int y = 0; y < rect.height; ++y)
        std::copy_n(tile.at(0, y), rect.width * tile.channels, wall.at(rect.x, rect.y + y));
}

}  // namespace

Wall wallOf(int width, int height, int columns, int rows) {
    Wall wall;
    wall.width = width;
    wall.height = height;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const int left = width * column / columns, top = height * row / rows;
            const PixelRect rect{left, top, width * (column + 1) / columns - left,
                                 height * (row + 1) / rows - top};
            wall.tiles.push_back({fmt::format("tile-{}-{}", row, column), 0, rect, rect});
        }
    return wall;
}

WallServers::WallServers(const Dataset& dataset, const Wall& wall, const Settings& settings,
                         double costOfLooking, std::size_t ranks, unsigned threads)
    : wall_(wall), near_(nearPlane(settings, dataset.manifest)) {
    const std::vector<std::string> hosts(ranks > 0 ? ranks : wall.tiles.size());
    const auto shares = tilesOfRanks(wall, hosts);
    CHECK(shares.ok());
    for (const std::vector<std::size_t>& share : *shares) {
        Result<std::unique_ptr<RankTiles>> rank =
            RankTiles::create(dataset, wall, share, settings, costOfLooking, threads);
        if (!rank) detail::checkFailed(__FILE__, __LINE__, rank.error().message);
        ranks_.push_back(std::move(rank).value());
        for (std::size_t i = 0; i < share.size(); ++i) tiles_.push_back(&(*ranks_.back())[i]);
    }
}

Picture WallServers::draw(const Camera& camera) {
    drawTiles(camera, protocol::kCaptureColor | protocol::kCaptureDepth);
    Picture picture{ColorImage(wall_.width, wall_.height, 3), DepthImage(wall_.width, wall_.height, 1)};
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
        paste(tiles_[i]->pixels().readColor(), wall_.tiles[i].onWall, picture.color);
        paste(tiles_[i]->pixels().readDepth(), wall_.tiles[i].onWall, picture.depth);
    }
    return picture;
}

void WallServers::drawOnly(const Camera& camera) {
    drawTiles(camera, 0);
}

void WallServers::drawTiles(const Camera& camera, std::uint32_t flags) {
    stats_ = {};
    tileStats_.clear();
    for (TilePipeline* tile : tiles_) {
        const protocol::TileStats stats = tile->draw(stateOf(camera, near_, flags));
        tileStats_.push_back(stats);
        stats_.visibilityMs += stats.visibilityMs;
        stats_.fetchWaitMs += stats.fetchWaitMs;
        stats_.drawMs += stats.drawMs;
        stats_.pyramidMs += stats.pyramidMs;
        stats_.testMs += stats.testMs;
        stats_.triangles += stats.triangles;
        stats_.hiddenPages += stats.hiddenPages;
        stats_.hiddenRanges += stats.hiddenRanges;
        stats_.badPages += stats.badPages;
        stats_.fetchedBytes += stats.fetchedBytes;
    }
}

Picture WallRenders::draw(const Wall& wall, const Camera& camera) {
    WallServers servers(dataset_, wall, settings_);
    Picture picture = servers.draw(camera);
    stats_ = servers.stats();
    return picture;
}

}  // namespace iwalk::tools
