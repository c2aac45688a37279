#pragma once

#include <vector>

#include "server/frame/page_drawing.hpp"

namespace iwalk {

// `--show birdseye`: instead of the tile's picture, what the frame has drawn for it, seen from above and
// aside; with the tile's frustum and the boxes of all pages that it meets: green those of which something
// was drawn, red those that were read for it, blue those that were left out.
class BirdsEye {
  public:
    // All outlive it.
    BirdsEye(const Hierarchy& hierarchy, const FrustumVisibility& visibility, PageCache& cache,
             Renderer& renderer, PageDrawing& pages)
        : hierarchy_(hierarchy), visibility_(visibility), cache_(cache), renderer_(renderer), pages_(pages) {}

    // Draws over the frame. `up`: the camera's; `drawn`: what PageDrawing has noted.
    void draw(const TileView& view, const glm::dvec3& up, const Cut& cut,
              const std::vector<PageDrawing::Drawn>& drawn);

  private:
    TileView above(const TileView& view, const glm::dvec3& up) const;
    std::vector<Line> boxes(const TileView& view, const LatticeEye& from, const Cut& cut,
                            const std::vector<PageDrawing::Drawn>& drawn) const;

    const Hierarchy& hierarchy_;
    const FrustumVisibility& visibility_;
    PageCache& cache_;
    Renderer& renderer_;
    PageDrawing& pages_;
};

}  // namespace iwalk
