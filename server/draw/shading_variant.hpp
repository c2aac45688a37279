#pragma once

#include <cstdint>

#include "server/draw/renderer.hpp"
#include "server/draw/shaders.hpp"

namespace iwalk {

// Which shading program a block needs; `rest`: its visibility buffer has a second layer.
inline std::uint32_t shadingVariant(const SceneLook& look, bool captureDepth, bool rest) {
    std::uint32_t variant = 0;
    if (captureDepth) variant |= kShadeDepth;
    if (rest) variant |= kShadeRest;
    if (look.normals && look.shading != Shading::flat) variant |= kShadeSmooth;
    if (look.tints) return variant | kShadeTint;
    if (look.overdraw) return variant | kShadeOverdraw;
    if (look.ramp == Ramp::height || (look.ramp == Ramp::automatic && !look.colors))
        return variant | kShadeRamp;
    if (look.colors) variant |= kShadeColors;
    return variant;
}

}  // namespace iwalk
