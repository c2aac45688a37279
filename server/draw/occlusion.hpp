#pragma once

#include <memory>

#include "server/draw/renderer.hpp"
#include "server/visibility/occlusion.hpp"
#include "server/visibility/workers.hpp"

namespace iwalk {

// Both look at the block that the renderer is drawing.

// Reads the depths back and builds a pyramid of them on the CPU (GigaWalk, section 5: hierarchical Z).
std::unique_ptr<Occlusion> makeDepthOcclusion(Renderer& renderer, Workers& workers);
// Asks the GL, one occlusion query a box, all of a call's under way at once. A query draws the box's
// rectangle at the box's nearest depth: the sides of the box themselves could slip between pixel centres.
Result<std::unique_ptr<Occlusion>> makeQueryOcclusion(Renderer& renderer);

Result<std::unique_ptr<Occlusion>> makeOcclusion(OcclusionTest test, Renderer& renderer, Workers& workers);

}  // namespace iwalk
