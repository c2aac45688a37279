#pragma once

#include <memory>

#include "server/draw/renderer.hpp"
#include "server/visibility/occlusion.hpp"

namespace iwalk::bench {

// The papers' third way, as a sparring partner: boxes are drawn with their numbers, against the depth but
// without writing it; whoever owns a pixel is not hidden, and is left out of the next round, until a round
// shows nobody. The renderer outlives it.
std::unique_ptr<Occlusion> makeItemBuffer(Renderer& renderer);

}  // namespace iwalk::bench
