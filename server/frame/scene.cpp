#include "server/frame/scene.hpp"

#include <glm/geometric.hpp>

#include "common/dataset/page_files.hpp"

namespace iwalk {
namespace {

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

Result<std::unique_ptr<Scene>> Scene::create(const Dataset& dataset, std::span<const PixelRect> tiles,
                                             const Settings& settings, unsigned threads) {
    RETURN_IF_ERROR(checkSettings(settings));
    auto scene = std::make_unique<Scene>(dataset, threads);
    ASSIGN_OR_RETURN(scene->renderer, Renderer::create(tiles, lookOf(dataset, settings)));
    ASSIGN_OR_RETURN(const std::uint64_t bytes, arenaBytes(dataset.hierarchy, settings.cacheBytes));
    ASSIGN_OR_RETURN(std::vector<std::span<std::byte>> memory, scene->renderer->lendArena(bytes));
    ASSIGN_OR_RETURN(PageFiles files, openPageFiles(dataset.path, dataset.manifest));
    scene->cache = std::make_unique<PageCache>(dataset.hierarchy, std::move(files),
                                               Arena(std::move(memory), Renderer::kArenaAlignment),
                                               settings.fetchThreads);
    scene->pages.emplace(dataset.hierarchy, *scene->cache, *scene->renderer);
    RETURN_IF_ERROR(scene->apply(settings));
    return scene;
}

Result<void> Scene::apply(const Settings& settings) {
    RETURN_IF_ERROR(renderer->setLook(lookOf(dataset, settings)));
    cut = cutAtLevel(dataset.hierarchy, settings.level);
    occlusion.reset();
    if (settings.mode != Mode::cplp) return {};
    ASSIGN_OR_RETURN(occlusion, makeOcclusion(settings.occlusion, *renderer, workers));
    return {};
}

double nearPlane(const Settings& settings, const Manifest& manifest) {
    if (settings.near > 0) return settings.near;
    return 1e-5 * glm::distance(manifest.bounds.min, manifest.bounds.max);
}

}  // namespace iwalk
