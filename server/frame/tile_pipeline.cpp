#include "server/frame/tile_pipeline.hpp"

#include <sys/resource.h>

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>

#include "common/dataset/page_files.hpp"
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

// The arena never needs more than the dataset's pages, decoded, and never less than the largest of them.
Result<std::uint64_t> arenaBytes(const Hierarchy& hierarchy, std::uint64_t cacheBytes) {
    std::uint64_t all = 0, largest = 0;
    for (const PageRecord& page : hierarchy.pages) {
        const std::uint64_t bytes = pageLayout(page).bytes;
        all += bytes;
        largest = std::max(largest, bytes);
    }
    if (largest > cacheBytes)
        return fail("--cache {} is less than one page of this dataset: give {} or more",
                    formatBytes(cacheBytes), formatBytes(largest));
    return std::min(all, cacheBytes);
}

SceneLook lookOf(const Dataset& dataset, const Settings& settings) {
    SceneLook look;
    look.stepExponent = dataset.manifest.stepExponent;
    look.bounds = Hierarchy::box(dataset.hierarchy.nodes[0]);
    look.colors = dataset.manifest.colors;
    look.normals = dataset.manifest.normals;
    look.shading = settings.shading;
    look.ramp = settings.ramp;
    look.background = settings.background;
    look.tints = Tints(dataset.hierarchy, settings.show);
    look.overdraw = settings.show == Show::overdraw;
    return look;
}

}  // namespace

Result<Dataset> openDataset(const std::string& path) {
    Dataset dataset;
    dataset.path = path;
    ASSIGN_OR_RETURN(dataset.manifest, loadManifest(path));
    ASSIGN_OR_RETURN(dataset.hierarchy, loadHierarchy(path, dataset.manifest));
    dataset.bytes = dataset.manifest.hierarchy.bytes;
    for (const DatasetFile& file : dataset.manifest.pageFiles) dataset.bytes += file.bytes;
    return dataset;
}

Result<std::unique_ptr<TilePipeline>> TilePipeline::create(const Dataset& dataset, const Wall& wall,
                                                           std::size_t tile, const Settings& settings,
                                                           double costOfLooking) {
    RETURN_IF_ERROR(checkSettings(settings));
    std::unique_ptr<TilePipeline> pipeline(new TilePipeline(dataset, wall, tile, costOfLooking));
    const PixelRect& rect = wall.tiles[tile].onScreen;
    ASSIGN_OR_RETURN(pipeline->renderer_, Renderer::create(rect, lookOf(dataset, settings)));
    ASSIGN_OR_RETURN(const std::uint64_t bytes, arenaBytes(dataset.hierarchy, settings.cacheBytes));
    ASSIGN_OR_RETURN(std::vector<std::span<std::byte>> memory, pipeline->renderer_->lendArena(bytes));
    ASSIGN_OR_RETURN(PageFiles files, openPageFiles(dataset.path, dataset.manifest));
    pipeline->cache_ = std::make_unique<PageCache>(dataset.hierarchy, std::move(files),
                                                   Arena(std::move(memory), Renderer::kArenaAlignment),
                                                   settings.fetchThreads);
    pipeline->pages_.emplace(dataset.hierarchy, *pipeline->cache_, *pipeline->renderer_);
    RETURN_IF_ERROR(pipeline->apply(settings));
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
    view.eye = LatticeEye::at(camera.eye, dataset_.manifest.stepExponent);
    view.near = std::ldexp(state.near, -dataset_.manifest.stepExponent);
    view.captureDepth = state.flags & protocol::kCaptureDepth;
    return view;
}

protocol::TileStats TilePipeline::draw(const FrameState& state) {
    protocol::TileStats stats;
    stats.tile = static_cast<std::uint32_t>(tile_);
    Stopwatch watch;

    const TileView view = viewOf(state);
    renderer_->beginFrame(view);
    depths_.clear();
    std::vector<BlockView> blocks;
    for (const Block& block : blocksOf(view.tile)) blocks.emplace_back(view, block);
    if (plp_) plp_->begin(cut_, {view.projection, view.tile, view.eye, view.near}, blocks, stats);
    std::vector<PageDrawing::Drawn> drawn;
    pages_->noteInto(birdsEye_ ? &drawn : nullptr);
    for (const BlockView& block : blocks) drawBlock(block, stats);
    pages_->noteInto(nullptr);
    if (birdsEye_) birdsEye_->draw(view, cameraOf(state).up, cut_, drawn);

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
    renderer_->sampleBlockDepths(depths_);
    cache_->release();

    addCounters(cache_->counters(), stats);
}

void TilePipeline::drawVisible(const BlockView& view, protocol::TileStats& stats) {
    Stopwatch watch;
    const std::vector<VisibleRanges> visible = visibility_.visible(cut_, view.frustum, view.eye);
    stats.visibilityMs += watch.lap();
    if (conservative_) return conservative_->drawBlock(view, visible, stats);
    cache_->beginFrame(pagesOf(visible));
    renderer_->beginBlock(view.block);
    pages_->drawAll(view, visible, stats);
    renderer_->finish();
}

double nearPlane(const Settings& settings, const Manifest& manifest) {
    if (settings.near > 0) return settings.near;
    return 1e-5 * glm::distance(manifest.bounds.min, manifest.bounds.max);
}

Result<void> TilePipeline::apply(const Settings& settings) {
    RETURN_IF_ERROR(renderer_->setLook(lookOf(dataset_, settings)));
    cut_ = cutAtLevel(dataset_.hierarchy, settings.level);
    plp_.reset();
    conservative_.reset();
    birdsEye_.reset();
    if (settings.show == Show::birdseye)
        birdsEye_.emplace(dataset_.hierarchy, visibility_, *cache_, *renderer_, *pages_);
    if (settings.mode == Mode::plp)
        plp_.emplace(dataset_.hierarchy, visibility_, *cache_, *renderer_, *pages_, settings);
    if (settings.mode != Mode::cplp) return {};
    ASSIGN_OR_RETURN(std::unique_ptr<Occlusion> occlusion, makeOcclusion(settings.occlusion, *renderer_));
    conservative_.emplace(visibility_, *cache_, *renderer_, *pages_, std::move(occlusion), costOfLooking_);
    return {};
}

}  // namespace iwalk
