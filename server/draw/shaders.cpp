#include "server/draw/shaders.hpp"

#include <epoxy/gl.h>

#include <string>

namespace iwalk {
namespace {

// Position streams, as in common/dataset/page.hpp.
const char* const kOffsets = R"(
uvec3 unpackNarrow(uvec2 p) {
    return uvec3(p.x & 0x1fffffu, (p.x >> 21) | ((p.y & 0x3ffu) << 11), (p.y >> 10) & 0x1fffffu);
}
)";

// Integer page origin (from the eye's cell, in double) plus integer offset, then one conversion to float: a
// vertex that two pages share has one eye-space position, bit for bit.
//
// The perspective division is done here, so that window positions can be snapped to 1/256 px of the screen,
// the grid of GL's rasteriser. Clip space spans a square of the screen whose edge is a power of two of px, so
// the viewport transform is exact, and every tile of a screen sees the same window positions but for whole
// pixels.
const char* const kVertex = R"(
layout(location = 0) uniform mat3 toPixels;
layout(location = 1) uniform float near;
layout(location = 2) uniform vec3 window;
layout(location = 3) uniform dvec3 pageOrigin;
#if WIDE
layout(location = 0) in uvec3 offset;
#else
layout(location = 0) in uvec2 packedOffset;
#endif
void main() {
#if !WIDE
    uvec3 offset = unpackNarrow(packedOffset);
#endif
    vec3 q = toPixels * vec3(pageOrigin + dvec3(offset));
    if (q.z >= near) {
        vec2 onScreen = round(q.xy / q.z * 256.0) * (1.0 / 256.0);
        gl_Position = vec4((onScreen - window.xy) / window.z, near / q.z, 1.0);
    } else {
        gl_Position = vec4((q.xy - q.z * window.xy) / window.z, near, q.z);
    }
}
)";

// Rasterisers interpolate depth with errors that have no bound for triangles thinner than a pixel: what is
// drawn could be nearer than the range's box. So it is cut off there, and what a box hides is truly hidden.
const char* const kVisibilityFragment = R"(
layout(location = 4) uniform uint firstId;
layout(location = 11) uniform float nearest = 1.0;
layout(location = 0) out uint id;
#if COUNTS
layout(binding = 0, r32ui) uniform uimage2D counts;
#else
layout(depth_less) out float gl_FragDepth;  // what is behind may be left out before this is known
#endif
void main() {
#if COUNTS
    imageAtomicAdd(counts, ivec2(gl_FragCoord.xy), 1u);
#endif
    id = firstId + uint(gl_PrimitiveID);
    gl_FragDepth = min(gl_FragCoord.z, nearest);
}
)";

// The next float away from the eye; infinitely far stays.
const char* const kRestFragment = R"(
layout(binding = 0) uniform sampler2D depths;
layout(location = 0) out uint id;
void main() {
    id = 0u;
    uint bits = floatBitsToUint(texelFetch(depths, ivec2(gl_FragCoord.xy), 0).r);
    gl_FragDepth = uintBitsToFloat(max(bits, 1u) - 1u);
}
)";

// A rectangle of a block at one depth, for an occlusion query.
const char* const kBox = R"(
layout(location = 11) uniform float nearest;
layout(location = 12) uniform vec4 corners;
void main() {
    gl_Position = vec4((gl_VertexID & 1) == 0 ? corners.x : corners.z, gl_VertexID < 2 ? corners.y : corners.w, nearest, 1.0);
}
)";
const char* const kNoFragment = "void main() {}\n";

// Positions from the eye, clipped by the GL; with the depths of what is drawn
// to tell what is behind it.
const char* const kLine = R"(
layout(location = 0) uniform mat3 toPixels;
layout(location = 1) uniform float near;
layout(location = 2) uniform vec3 window;
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 color;
layout(location = 2) in float behind;
flat out vec4 lineColor;
flat out float lineBehind;
void main() {
    vec3 q = toPixels * place;
    gl_Position = vec4((q.xy - q.z * window.xy) / window.z, near, q.z);
    lineColor = color;
    lineBehind = behind;
}
)";
const char* const kLineFragment = R"(
layout(location = 10) uniform ivec2 inBlock;
layout(binding = 1) uniform sampler2D depths;
flat in vec4 lineColor;
flat in float lineBehind;
layout(location = 0) out vec4 color;
void main() {
    bool behind = gl_FragCoord.z < texelFetch(depths, ivec2(gl_FragCoord.xy) + inBlock, 0).r;
    color = vec4(lineColor.rgb, behind ? lineBehind : 1.0);
}
)";

const char* const kWholeTile = R"(
void main() {
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}
)";

// Nothing is interpolated: the triangle is looked up, and everything is computed from its corners and the
// pixel's place on the screen, so that a pixel comes out the same on whatever tile it lies.
const char* const kShadingFragment = R"(
layout(location = 0) uniform mat3 toPixels;
layout(location = 1) uniform float near;
layout(location = 5) uniform vec2 tileOrigin;
layout(location = 6) uniform mat3 toDirection;
layout(location = 7) uniform uint bank;
layout(location = 8) uniform float stepSize;
layout(location = 9) uniform vec2 ramp;
layout(location = 10) uniform ivec2 inBlock;
layout(binding = 0) uniform usampler2D visible;
#if REST
layout(binding = 1) uniform sampler2D depths;
layout(binding = 2) uniform usampler2D visibleRest;
layout(binding = 3) uniform sampler2D depthsRest;
#endif
// Buffers are read as textures: llvmpipe fetches texels for all pixels of a vector at once, but words of storage
// buffers for one after another.
layout(binding = 4) uniform usamplerBuffer pairs;
layout(binding = 5) uniform usamplerBuffer pages;
#if TINT
layout(std430, binding = 0) readonly buffer Tints { uint tints[]; };
#endif
#if OVERDRAW
layout(binding = 0, r32ui) readonly uniform uimage2D counts;
#endif

layout(location = 0) out vec4 color;
#if DEPTH
layout(location = 1) out float depth;
#endif

// 32-bit words of the bank, two in a texel. Streams and narrow positions begin a texel.
uint wordAt(uint at) {
    uvec2 pair = texelFetch(pairs, int(at >> 1)).rg;
    return (at & 1u) == 0u ? pair.x : pair.y;
}

uvec3 cornerIndices(uint stream, uint triangle) {
    uint first = 3u * triangle;
    uint at = stream + (first >> 1);
    uint a = wordAt(at), b = wordAt(at + 1u);
    return (first & 1u) == 0u ? uvec3(a & 0xffffu, a >> 16, b & 0xffffu) : uvec3(a >> 16, b & 0xffffu, b >> 16);
}

uvec3 offsetOf(uint stream, bool wide, uint vertex) {
    uint at = stream + (wide ? 3u : 2u) * vertex;
    uvec2 pair = texelFetch(pairs, int(at >> 1)).rg, next = texelFetch(pairs, int(at >> 1) + 1).rg;
    if (wide) return (at & 1u) == 0u ? uvec3(pair, next.x) : uvec3(pair.y, next);
    return unpackNarrow(pair);
}

// Unsigned differences, each exact before it becomes a float.
vec3 edge(uvec3 from, uvec3 to) {
    return mix(-vec3(from - to), vec3(to - from), greaterThanEqual(to, from));
}

vec3 colorOf(uint stream, uint vertex) {
    return unpackUnorm4x8(wordAt(stream + vertex)).rgb;
}

vec3 normalOf(uint stream, uint vertex) {
    vec2 p = unpackSnorm2x16(wordAt(stream + vertex));
    vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
    return normalize(n);
}

// Blue lowlands over green and sand to white: five colours at equal distances.
vec3 rampColor(float height) {
    const vec3 stops[5] = vec3[](vec3(0.18, 0.31, 0.56), vec3(0.20, 0.58, 0.58), vec3(0.52, 0.72, 0.40),
                                 vec3(0.92, 0.76, 0.42), vec3(0.97, 0.94, 0.90));
    float at = clamp(height, 0.0, 1.0) * 4.0;
    int i = min(int(at), 3);
    return mix(stops[i], stops[i + 1], at - float(i));
}

#if TINT
// Of the last range that begins at or before the triangle.
vec3 tintOf(uint at, uint triangle) {
    uint low = 0u, high = tints[at];
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (tints[at + 1u + 2u * middle] <= triangle) low = middle;
        else high = middle;
    }
    return unpackUnorm4x8(tints[at + 2u + 2u * low]).rgb;
}
#endif

// Part 0 to 3 of a triangle's page (ShadedPage).
uvec4 pageOf(uint id, uint part) {
    return texelFetch(pages, int(4u * ((id >> 16) - 1u) + part));
}

// The nearest triangle; of equally near ones the first in the order of pages, then in the page.
uint nearestTriangle(ivec2 pixel) {
    uint first = texelFetch(visible, pixel, 0).r;
#if REST
    uint rest = texelFetch(visibleRest, pixel, 0).r;
    if (rest == 0u) return first;
    bool tie = first != 0u && texelFetch(depths, pixel, 0).r == texelFetch(depthsRest, pixel, 0).r;
    if (!tie) return rest;
    uint rankFirst = pageOf(first, 3u).z, rankRest = pageOf(rest, 3u).z;
    bool restIsFirst = rankRest < rankFirst || (rankRest == rankFirst && (rest & 0xffffu) < (first & 0xffffu));
    if (restIsFirst) return rest;
#endif
    return first;
}

void main() {
    uint id = nearestTriangle(ivec2(gl_FragCoord.xy) + inBlock);
    if (id == 0u) discard;
    uvec4 about = pageOf(id, 3u);
    if (about.x != bank) discard;
    uvec4 streams = pageOf(id, 2u), originXY = pageOf(id, 0u);
    dvec3 origin = dvec3(packDouble2x32(originXY.xy), packDouble2x32(originXY.zw), packDouble2x32(pageOf(id, 1u).xy));
    bool wide = about.y != 0u;
    uvec3 corner = cornerIndices(streams.w, id & 0xffffu);
    uvec3 first = offsetOf(streams.x, wide, corner.x);
    vec3 a = vec3(origin + dvec3(first));
    vec3 ab = edge(first, offsetOf(streams.x, wide, corner.y)), ac = edge(first, offsetOf(streams.x, wide, corner.z));

    // Squared areas of the largest triangles must stay within a float.
    float scale = wide ? 1.0 / 65536.0 : 1.0;
    vec3 faceNormal = cross(ab * scale, ac * scale);
    vec3 direction = toDirection * vec3(gl_FragCoord.xy + tileOrigin, 1.0);

    vec3 base = vec3(0.8);
    vec3 normal = faceNormal;
    // Where the pixel's ray meets the triangle's plane, in steps along the screen's normal. Edge on, the plane says
    // little: stay within the corners' distances.
    vec3 forward = vec3(toPixels[0].z, toPixels[1].z, toPixels[2].z);
    vec3 distances = vec3(0.0, dot(forward, ab), dot(forward, ac)) + dot(forward, a);
    float nearest = max(near, min(distances.x, min(distances.y, distances.z)));
    float farthest = max(nearest, max(distances.x, max(distances.y, distances.z)));
    float slope = dot(faceNormal, direction);
    float t = slope == 0.0 ? nearest : clamp(dot(faceNormal, a) / slope, nearest, farthest);
#if COLORS || SMOOTH
    // Barycentric weights of the second and third corner.
    vec3 inside = (t * direction - a) * scale;
    float area = dot(faceNormal, faceNormal);
    vec2 weight = vec2(dot(cross(inside, ac * scale), faceNormal), dot(cross(ab * scale, inside), faceNormal));
    weight = area > 0.0 ? clamp(weight / area, 0.0, 1.0) : vec2(0.0);
#endif
#if RAMP
    base = rampColor((t * direction.z - ramp.x) * ramp.y);
#endif
#if TINT
    base = tintOf(about.w, id & 0xffffu);
#endif
#if OVERDRAW
    base = rampColor(log2(float(imageLoad(counts, ivec2(gl_FragCoord.xy) + inBlock).r)) / 8.0);
#endif
#if COLORS
    vec3 c0 = colorOf(streams.y, corner.x);
    base = clamp(c0 + (colorOf(streams.y, corner.y) - c0) * weight.x + (colorOf(streams.y, corner.z) - c0) * weight.y, 0.0, 1.0);
#endif
#if SMOOTH
    vec3 n0 = normalOf(streams.z, corner.x);
    normal = n0 + (normalOf(streams.z, corner.y) - n0) * weight.x + (normalOf(streams.z, corner.z) - n0) * weight.y;
#endif
    // Headlight, both sides alike.
    float lengths = sqrt(dot(normal, normal) * dot(direction, direction));
    float facing = lengths > 0.0 ? min(1.0, abs(dot(normal, direction)) / lengths) : 1.0;
    color = vec4(base * (0.25 + 0.75 * facing), 1.0);
#if DEPTH
    depth = t * stepSize;
#endif
}
)";

Result<GLuint> compileStage(GLenum stage, const std::string& source) {
    const GLuint shader = glCreateShader(stage);
    const char* text = source.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled) return shader;
    char log[4096] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    glDeleteShader(shader);
    return fail("the GL does not take iWalk's shader: {}", log);
}

Result<GLuint> link(GLuint vertex, GLuint fragment) {
    const GLuint program = glCreateProgram();
    glAttachShader(program, vertex);
    glAttachShader(program, fragment);
    glLinkProgram(program);
    glDeleteShader(vertex);
    glDeleteShader(fragment);
    GLint linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked) return program;
    char log[4096] = "";
    glGetProgramInfoLog(program, sizeof log, nullptr, log);
    glDeleteProgram(program);
    return fail("the GL does not link iWalk's shaders: {}", log);
}

std::string define(const char* name, bool value) {
    return fmt::format("#define {} {}\n", name, value ? 1 : 0);
}

Result<std::uint32_t> compile(const std::string& defines, const char* vertexSource,
                              const char* fragmentSource) {
    const std::string preamble = "#version 450 core\n" + defines + kOffsets;
    ASSIGN_OR_RETURN(const GLuint vertex, compileStage(GL_VERTEX_SHADER, preamble + vertexSource));
    ASSIGN_OR_RETURN(const GLuint fragment, compileStage(GL_FRAGMENT_SHADER, preamble + fragmentSource));
    return link(vertex, fragment);
}

}  // namespace

Result<void> compileVisibilityPrograms(std::array<std::uint32_t, 2>& programs, bool counts) {
    for (const bool wide : {false, true}) {
        const std::string defines = define("WIDE", wide) + define("COUNTS", counts);
        glDeleteProgram(programs[wide]);
        ASSIGN_OR_RETURN(programs[wide], compile(defines, kVertex, kVisibilityFragment));
    }
    return {};
}

Result<std::uint32_t> compileRestProgram() {
    return compile("", kWholeTile, kRestFragment);
}

Result<std::uint32_t> compileBoxProgram() {
    return compile("", kBox, kNoFragment);
}

Result<std::uint32_t> compileLineProgram() {
    return compile("", kLine, kLineFragment);
}

Result<std::uint32_t> compileShadingProgram(std::uint32_t variant) {
    return compile(define("COLORS", variant & kShadeColors) + define("SMOOTH", variant & kShadeSmooth) +
                       define("DEPTH", variant & kShadeDepth) + define("RAMP", variant & kShadeRamp) +
                       define("REST", variant & kShadeRest) + define("TINT", variant & kShadeTint) +
                       define("OVERDRAW", variant & kShadeOverdraw),
                   kWholeTile, kShadingFragment);
}

}  // namespace iwalk
