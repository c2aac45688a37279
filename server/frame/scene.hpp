#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/settings.hpp"
#include "server/cache/page_cache.hpp"
#include "server/draw/occlusion.hpp"
#include "server/frame/page_drawing.hpp"

namespace iwalk {

// A dataset, opened and checked.
struct Dataset {
    std::string path;
    Manifest manifest;
    Hierarchy hierarchy;
    std::uint64_t bytes = 0;  // of all files that the manifest names
};
Result<Dataset> openDataset(const std::string& path);

// What all tiles of a rank have in common, whatever each of them sees: the cut, the pages in memory, under
// one limit and with one set of fetch threads, and what draws. Tiles use it one after another. Needs a
// current GL context.
struct Scene {
    // `tiles`: px of their screens. The dataset is kept by reference. `threads`: of visibility, with this
    // one.
    static Result<std::unique_ptr<Scene>> create(const Dataset& dataset, std::span<const PixelRect> tiles,
                                                 const Settings& settings, unsigned threads);

    // The next frame is drawn with these; what is not live stays as it was.
    Result<void> apply(const Settings& settings);

    Scene(const Dataset& from, unsigned threads)
        : dataset(from), visibility(from.hierarchy), workers(threads) {}

    const Dataset& dataset;
    const FrustumVisibility visibility;
    Workers workers;  // of visibility
    Cut cut;
    std::unique_ptr<Renderer> renderer;
    std::unique_ptr<PageCache> cache;  // after the renderer, whose memory it uses
    std::optional<PageDrawing> pages;
    std::unique_ptr<Occlusion> occlusion;  // in mode cplp
};

// What near plane rank 0 puts into the frame state: the setting, or a hundred thousandth of the model's
// diagonal. Depth precision does not depend on it (reversed, in floats), so it is small enough to be
// forgotten. Model units.
double nearPlane(const Settings& settings, const Manifest& manifest);

}  // namespace iwalk
