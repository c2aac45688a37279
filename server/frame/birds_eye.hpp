#pragma once

#include <vector>

#include "server/frame/scene.hpp"

namespace iwalk {

// `--show birdseye`: instead of the tile's picture, what the frame has drawn for it, seen from above and
// aside; with the tile's frustum and the boxes of all pages that it meets: green those of which something
// was drawn, red those that were read for it, blue those that were left out.
class BirdsEye {
  public:
    // Both outlive it.
    BirdsEye(Scene& scene, TilePixels& pixels) : scene_(scene), pixels_(pixels) {}

    // Draws over the frame. `up`: the camera's; `drawn`: what PageDrawing has noted.
    void draw(const TileView& view, const glm::dvec3& up, const std::vector<PageDrawing::Drawn>& drawn);

  private:
    TileView above(const TileView& view, const glm::dvec3& up) const;
    std::vector<Line> boxes(const TileView& view, const LatticeEye& from,
                            const std::vector<PageDrawing::Drawn>& drawn) const;

    Scene& scene_;
    TilePixels& pixels_;
};

}  // namespace iwalk
