#pragma once

#include <array>
#include <cstdint>

#include "common/result.hpp"

// A frame is drawn in two passes. The first rasterises pages into a visibility buffer: for each pixel the
// nearest triangle's number, (slot of its page + 1) << 16 | triangle in the page, or 0. The second shades
// each pixel once.
namespace iwalk {

// What a shading program is compiled for: bits.
enum ShadingVariant : std::uint32_t {
    kShadeColors = 1,     // pages have colours, and they are used
    kShadeSmooth = 2,     // pages have normals, and they are used
    kShadeDepth = 4,      // writes eye-space depth to a second target
    kShadeRamp = 8,       // coloured by height
    kShadeRest = 16,      // the visibility buffer has a second layer
    kShadeTint = 32,      // coloured by Tints
    kShadeOverdraw = 64,  // coloured by how many triangles cover a pixel
    kShadeVariants = 128,
};

// Where the uniforms are; the same in all programs that have them.
enum UniformLocation : std::int32_t {
    kToPixels = 0,  // mat3
    kNear = 1,      // float, steps
    kWindow = 2,    // vec3: centre (px of the screen) and half edge (px) of the square that clip space spans
    kPageOrigin = 3,   // dvec3, from the eye, steps
    kFirstId = 4,      // uint: the number of the draw's first triangle
    kTileOrigin = 5,   // vec2, px of the screen
    kToDirection = 6,  // mat3
    kBank = 7,         // uint: the arena's bank that is bound
    kStepSize = 8,     // float, model units
    kRamp = 9,         // vec2: height (from the eye, steps) where the ramp begins, and 1 / its length
    kInBlock = 10,     // ivec2: the tile's origin less the block's, px
    kNearest = 11,     // float: no depth of the draw is nearer
    kBoxCorners = 12,  // vec4: of a rectangle, in clip space
};

// What the second pass knows of a page, by slot: four texels of GL_RGBA32UI.
struct ShadedPage {
    double origin[4];          // from the eye, steps; the last is unused
    std::uint32_t streams[4];  // where positions, colours, normals, indices begin: 32-bit words into the bank
    std::uint32_t bank;
    std::uint32_t wide;  // 1: positions as 3 x 32 bits
    std::uint32_t rank;  // pages of equal depth: the lower one is seen
    std::uint32_t
        tints;  // where its tints begin, 32-bit words: their number, then first triangle and tint of each
};
static_assert(sizeof(ShadedPage) == 64);

enum TextureUnit : std::uint32_t { kPairsUnit = 4, kPagesUnit = 5 };  // the bank as GL_RG32UI; ShadedPages
enum StorageBinding : std::uint32_t { kTintsBinding = 0 };
enum ImageBinding : std::uint32_t { kCountsBinding = 0 };  // how many triangles cover each pixel of a block

// Compile and link; the error holds the GL's log. The first pass comes for narrow and for wide pages, which
// replace `programs`, and may count triangles on the way.
Result<void> compileVisibilityPrograms(std::array<std::uint32_t, 2>& programs, bool counts);
Result<std::uint32_t> compileRestProgram();  // begins the visibility buffer's second layer
Result<std::uint32_t> compileBoxProgram();   // a rectangle at one depth, no colour
Result<std::uint32_t> compileLineProgram();  // attributes as in draw/lines.cpp
Result<std::uint32_t> compileShadingProgram(std::uint32_t variant);

}  // namespace iwalk
