#include "server/present/blend_pass.hpp"

#include <epoxy/gl.h>

#include "server/draw/gl_objects.hpp"

namespace iwalk {
namespace {

constexpr GLuint kGroup = 16;  // px in each direction
constexpr GLint kShared = 0, kGamma = 1;

const char* const kShader = R"(#version 450 core
layout(local_size_x = 16, local_size_y = 16) in;
layout(rgba8, binding = 1) readonly uniform image2D drawn;
layout(rgba8, binding = 2) writeonly uniform image2D shown;
layout(location = 0) uniform ivec4 sharedPx;  // left, right, top, bottom
layout(location = 1) uniform float gamma;

vec3 power(vec3 v, float exponent) {
    return mix(vec3(0.0), pow(max(v, 1e-30), vec3(exponent)), greaterThan(v, vec3(0.0)));
}

// Of two neighbours the right (or lower) one's part of the light, and 1 where this tile is that one.
vec2 neighbours(int at, int size, int before, int after) {
    if (at < before) return vec2((float(at) + 0.5) / float(before), 1.0);
    if (at >= size - after) return vec2((float(at - size + after) + 0.5) / float(after), 0.0);
    return vec2(0.0);
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(drawn);
    if (any(greaterThanEqual(pixel, size))) return;
    vec2 x = neighbours(pixel.x, size.x, sharedPx.x, sharedPx.y);
    vec2 y = neighbours(pixel.y, size.y, sharedPx.z, sharedPx.w);
    float part[4] = float[]((1.0 - x.s) * (1.0 - y.s), x.s * (1.0 - y.s), (1.0 - x.s) * y.s, x.s * y.s);
    int mine = int(x.t) + 2 * int(y.t);

    // All tiles that show the pixel count in the same order until their own turn comes.
    vec3 rest = power(imageLoad(drawn, pixel).rgb, gamma), value = vec3(0.0);
    float parts = 1.0;
    for (int turn = 0; turn < 4; ++turn) {
        int next = 0;
        for (int i = 1; i < 4; ++i)
            if (part[i] > part[next]) next = i;
        value = floor(power(rest * min(1.0, part[next] / parts), 1.0 / gamma) * 255.0 + 0.5) / 255.0;
        if (next == mine) break;
        rest = max(rest - power(value, gamma), 0.0);
        parts -= part[next];
        part[next] = 0.0;
    }
    imageStore(shown, pixel, vec4(value, 1.0));
}
)";

class GlBlendPass : public BlendPass {
  public:
    GlBlendPass(int width, int height, const Blend& blend) : width_(width), height_(height), blend_(blend) {}
    ~GlBlendPass() override {
        glDeleteProgram(program_);
        glDeleteTextures(1, &shown_);
    }

    Result<void> prepare() {
        program_ = glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &kShader);
        GLint linked = GL_FALSE;
        glGetProgramiv(program_, GL_LINK_STATUS, &linked);
        if (!linked) {
            char log[4096] = "";
            glGetProgramInfoLog(program_, sizeof log, nullptr, log);
            return fail("the GL does not take iWalk's blending shader: {}", log);
        }
        shown_ = makeTexture(GL_RGBA8, width_, height_);
        glProgramUniform4i(program_, kShared, blend_.left, blend_.right, blend_.top, blend_.bottom);
        glProgramUniform1f(program_, kGamma, static_cast<float>(blend_.gamma));
        return {};
    }

    std::uint32_t apply(std::uint32_t drawn) override {
        const auto groups = [](int px) { return (static_cast<GLuint>(px) + kGroup - 1) / kGroup; };
        glUseProgram(program_);
        glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
        glBindImageTexture(1, drawn, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA8);
        glBindImageTexture(2, shown_, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
        glDispatchCompute(groups(width_), groups(height_), 1);
        glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT);
        return shown_;
    }

  private:
    const int width_, height_;  // px
    const Blend blend_;
    GLuint program_ = 0, shown_ = 0;
};

}  // namespace

Result<std::unique_ptr<BlendPass>> BlendPass::create(int width, int height, const Blend& blend) {
    auto pass = std::make_unique<GlBlendPass>(width, height, blend);
    RETURN_IF_ERROR(pass->prepare());
    return std::unique_ptr<BlendPass>(std::move(pass));
}

}  // namespace iwalk
