#include "server/frame/tile_pipeline.hpp"

#include <sys/resource.h>

#include <cmath>

#include "server/frame/tile_counters.hpp"

namespace iwalk {
namespace {

std::uint64_t peakRssBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

Camera cameraOf(const FrameState& state) {
    const auto vector = [](const double(&v)[3]) { return glm::dvec3(v[0], v[1], v[2]); };
    return {vector(state.eye), vector(state.target), vector(state.up), state.fovY};
}

}  // namespace

Result<std::unique_ptr<TilePipeline>> TilePipeline::create(Scene& scene, const Wall& wall, std::size_t tile,
                                                           const Settings& settings, double costOfLooking) {
    std::unique_ptr<TilePipeline> pipeline(new TilePipeline(scene, wall, tile, costOfLooking));
    const PixelRect& rect = wall.tiles[tile].onScreen;
    ASSIGN_OR_RETURN(pipeline->pixels_, TilePixels::create(rect.width, rect.height));
    pipeline->apply(settings);
    return pipeline;
}

TileView TilePipeline::viewOf(const FrameState& state) const {
    const Camera camera = cameraOf(state);
    const Tile& tile = wall_.tiles[tile_];
    const Screen screen = wall_.screens(camera.fovY)[tile.screen];
    TileView view;
    view.projection = projectScreen(screen, camera);
    view.screenWidth = screen.width;
    view.screenHeight = screen.height;
    view.tile = tile.onScreen;
    view.eye = LatticeEye::at(camera.eye, scene_.dataset.manifest.stepExponent);
    view.near = std::ldexp(state.near, -scene_.dataset.manifest.stepExponent);
    view.captureDepth = state.flags & protocol::kCaptureDepth;
    return view;
}

protocol::TileStats TilePipeline::draw(const FrameState& state) {
    protocol::TileStats stats;
    stats.tile = static_cast<std::uint32_t>(tile_);
    Stopwatch watch;

    const TileView view = viewOf(state);
    scene_.renderer->beginFrame(view, *pixels_);
    depths_.clear();
    std::vector<BlockView> blocks;
    if (plp_)
        blocks = plp_->begin(scene_.cut, view, stats);
    else
        for (const Block& block : blocksOf(view.tile)) blocks.emplace_back(view, block);
    std::vector<PageDrawing::Drawn> drawn;
    scene_.pages->noteInto(birdsEye_ ? &drawn : nullptr);
    for (const BlockView& block : blocks) drawBlock(block, stats);
    scene_.pages->noteInto(nullptr);
    if (birdsEye_) birdsEye_->draw(view, cameraOf(state).up, drawn);

    addDepths(depths_, state.near, stats);

    stats.visibilityMs += stats.pyramidMs + stats.testMs;
    stats.drawMs = watch.lap() - stats.visibilityMs - stats.fetchWaitMs;
    stats.peakRssBytes = peakRssBytes();
    return stats;
}

void TilePipeline::drawBlock(const BlockView& view, protocol::TileStats& stats) {
    if (plp_)
        plp_->drawBlock(view, stats);
    else
        drawVisible(view, stats);
    scene_.renderer->sampleBlockDepths(depths_);
    scene_.cache->release();

    addCounters(scene_.cache->counters(), stats);
}

void TilePipeline::drawVisible(const BlockView& view, protocol::TileStats& stats) {
    Stopwatch watch;
    const std::vector<VisibleRanges> visible = scene_.visibility.visible(scene_.cut, view.frustum, view.eye);
    stats.visibilityMs += watch.lap();
    if (conservative_) return conservative_->drawBlock(view, visible, stats);
    scene_.cache->beginFrame(pagesOf(visible));
    scene_.renderer->beginBlock(view.block);
    scene_.pages->drawAll(view, visible, stats);
    scene_.renderer->finish();
}

void TilePipeline::apply(const Settings& settings) {
    plp_.reset();
    conservative_.reset();
    birdsEye_.reset();
    if (settings.show == Show::birdseye) birdsEye_.emplace(scene_, *pixels_);
    if (settings.mode == Mode::plp)
        plp_.emplace(scene_.dataset.hierarchy, scene_.visibility, *scene_.cache, *scene_.renderer,
                     *scene_.pages, scene_.workers, settings);
    if (settings.mode == Mode::cplp)
        conservative_.emplace(scene_.visibility, *scene_.cache, *scene_.renderer, *scene_.pages,
                              *scene_.occlusion, costOfLooking_);
}

}  // namespace iwalk
