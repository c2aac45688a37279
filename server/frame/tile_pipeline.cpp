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

std::vector<std::uint32_t> pagesOf(const std::vector<VisibleRanges>& visible) {
    std::vector<std::uint32_t> pages;
    for (const VisibleRanges& ranges : visible)
        if (pages.empty() || pages.back() != ranges.page) pages.push_back(ranges.page);
    return pages;
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
                                                           std::size_t tile, const Settings& settings) {
    std::unique_ptr<TilePipeline> pipeline(new TilePipeline(dataset, wall, tile, settings.level));
    const PixelRect& rect = wall.tiles[tile].onScreen;
    ASSIGN_OR_RETURN(pipeline->renderer_, Renderer::create(rect, lookOf(dataset, settings)));
    ASSIGN_OR_RETURN(const std::uint64_t bytes, arenaBytes(dataset.hierarchy, settings.cacheBytes));
    ASSIGN_OR_RETURN(std::vector<std::span<std::byte>> memory, pipeline->renderer_->lendArena(bytes));
    ASSIGN_OR_RETURN(PageFiles files, openPageFiles(dataset.path, dataset.manifest));
    pipeline->cache_ = std::make_unique<PageCache>(dataset.hierarchy, std::move(files),
                                                   Arena(std::move(memory), Renderer::kArenaAlignment),
                                                   settings.fetchThreads);
    if (settings.mode == Mode::plp)
        pipeline->plp_.emplace(dataset.hierarchy, pipeline->visibility_, settings);
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
    if (plp_) plp_->choose(cut_, {view.projection, view.tile, view.eye, view.near}, *cache_, stats);
    for (const Block& block : blocksOf(view.tile)) drawBlock(view, block, stats);

    stats.drawMs = watch.lap() - stats.visibilityMs - stats.fetchWaitMs;
    stats.peakRssBytes = peakRssBytes();
    return stats;
}

void TilePipeline::drawBlock(const TileView& view, const Block& block, protocol::TileStats& stats) {
    Stopwatch watch;
    // The snapping of vertices moves the picture by less than a pixel.
    const Frustum frustum = frustumOf(view.projection, block.part, 1, view.near);
    const std::vector<VisibleRanges> visible =
        plp_ ? plp_->visible(frustum, view.eye) : visibility_.visible(cut_, frustum, view.eye);
    stats.visibilityMs += watch.lap();

    cache_->beginFrame(pagesOf(visible));
    renderer_->beginBlock(block);
    drawPages(visible, frustum, view.eye, stats);
    renderer_->finish();
    cache_->release();

    addCounters(cache_->counters(), stats);
}

void TilePipeline::drawPages(const std::vector<VisibleRanges>& visible, const Frustum& frustum,
                             const LatticeEye& eye, protocol::TileStats& stats) {
    std::vector<IndexRun> runs;
    for (auto ranges = visible.begin(); ranges != visible.end();) {
        PageCache::Next next = cache_->next();
        while (next.answer == PageCache::Answer::full) {
            renderer_->finish();
            cache_->release();
            next = cache_->next();
        }
        const std::uint32_t page = ranges->page;
        runs.clear();
        for (; ranges != visible.end() && ranges->page == page; ++ranges) {
            if (next.answer == PageCache::Answer::skipped) continue;
            CHECK_OP(next.page.page, ==, page);
            stats.ranges +=
                cullRanges(*next.page.table, ranges->firstRange, ranges->rangeCount, frustum, eye, runs);
        }
        if (runs.empty()) continue;
        renderer_->draw(next.page, dataset_.hierarchy.pages[page], runs);
        for (const IndexRun& run : runs) stats.triangles += run.indexCount / 3;
    }
}

double nearPlane(const Settings& settings, const Manifest& manifest) {
    if (settings.near > 0) return settings.near;
    return 1e-5 * glm::distance(manifest.bounds.min, manifest.bounds.max);
}

}  // namespace iwalk
