#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/protocol.hpp"
#include "common/settings.hpp"
#include "server/cache/page_cache.hpp"
#include "server/draw/renderer.hpp"
#include "server/frame/birds_eye.hpp"
#include "server/frame/conservative.hpp"
#include "server/frame/frame_state.hpp"
#include "server/frame/plp_frame.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// A dataset, opened and checked.
struct Dataset {
    std::string path;
    Manifest manifest;
    Hierarchy hierarchy;
    std::uint64_t bytes = 0;  // of all files that the manifest names
};
Result<Dataset> openDataset(const std::string& path);

// From a frame state to one tile's pixels: adapt, visibility, cache, draw. Knows nothing of MPI and sockets;
// needs a current GL context.
class TilePipeline {
  public:
    // `costOfLooking`: of ConservativeDrawing.
    static Result<std::unique_ptr<TilePipeline>> create(
        const Dataset& dataset, const Wall& wall, std::size_t tile, const Settings& settings,
        double costOfLooking = ConservativeDrawing::kCostOfLooking);

    // Draws the frame completely, however long the pages take, into the renderer's framebuffer.
    protocol::TileStats draw(const FrameState& state);

    // The next frame is drawn with these; what is not live stays as it was.
    Result<void> apply(const Settings& settings);

    Renderer& renderer() { return *renderer_; }

  private:
    TilePipeline(const Dataset& dataset, const Wall& wall, std::size_t tile, double costOfLooking)
        : dataset_(dataset),
          wall_(wall),
          tile_(tile),
          costOfLooking_(costOfLooking),
          visibility_(dataset.hierarchy) {}

    TileView viewOf(const FrameState& state) const;
    void drawBlock(const BlockView& view, protocol::TileStats& stats);
    void drawVisible(const BlockView& view, protocol::TileStats& stats);

    const Dataset& dataset_;
    const Wall& wall_;
    const std::size_t tile_;
    const double costOfLooking_;
    Cut cut_;
    const FrustumVisibility visibility_;
    std::vector<float> depths_;  // some of the frame's, window depths
    std::unique_ptr<Renderer> renderer_;
    std::unique_ptr<PageCache> cache_;  // after the renderer, whose memory it uses
    std::optional<PageDrawing> pages_;
    std::optional<PlpFrame> plp_;                      // with --mode plp
    std::optional<ConservativeDrawing> conservative_;  // with --mode cplp
    std::optional<BirdsEye> birdsEye_;                 // with --show birdseye
};

// What near plane rank 0 puts into the frame state: the setting, or a hundred thousandth of the model's
// diagonal. Depth precision does not depend on it (reversed, in floats), so it is small enough to be
// forgotten. Model units.
double nearPlane(const Settings& settings, const Manifest& manifest);

}  // namespace iwalk
