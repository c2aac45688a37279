#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/protocol.hpp"
#include "common/settings.hpp"
#include "server/frame/birds_eye.hpp"
#include "server/frame/conservative.hpp"
#include "server/frame/frame_state.hpp"
#include "server/frame/plp_frame.hpp"
#include "server/frame/scene.hpp"
#include "server/wall/wall.hpp"

namespace iwalk {

// From a frame state to one tile's pixels: adapt, visibility, cache, draw. Keeps what the tile alone knows
// from frame to frame. Knows nothing of MPI and sockets; needs a current GL context.
class TilePipeline {
  public:
    // The scene, which must know of the tile, and the wall are kept by reference. `costOfLooking`: of
    // ConservativeDrawing.
    static Result<std::unique_ptr<TilePipeline>> create(
        Scene& scene, const Wall& wall, std::size_t tile, const Settings& settings,
        double costOfLooking = ConservativeDrawing::kCostOfLooking);

    // Draws the frame completely, however long the pages take, into the tile's pixels.
    protocol::TileStats draw(const FrameState& state);

    // After the scene has applied them.
    void apply(const Settings& settings);

    TilePixels& pixels() { return *pixels_; }

  private:
    TilePipeline(Scene& scene, const Wall& wall, std::size_t tile, double costOfLooking)
        : scene_(scene), wall_(wall), tile_(tile), costOfLooking_(costOfLooking) {}

    TileView viewOf(const FrameState& state) const;
    void drawBlock(const BlockView& view, protocol::TileStats& stats);
    void drawVisible(const BlockView& view, protocol::TileStats& stats);

    Scene& scene_;
    const Wall& wall_;
    const std::size_t tile_;
    const double costOfLooking_;
    std::unique_ptr<TilePixels> pixels_;
    std::vector<float> depths_;                        // some of the frame's, window depths
    std::optional<PlpFrame> plp_;                      // in mode plp
    std::optional<ConservativeDrawing> conservative_;  // in mode cplp
    std::optional<BirdsEye> birdsEye_;                 // with --show birdseye
};

}  // namespace iwalk
