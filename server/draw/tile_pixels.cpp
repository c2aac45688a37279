#include "server/draw/tile_pixels.hpp"

#include <epoxy/gl.h>

#include <algorithm>

#include "common/check.hpp"
#include "server/draw/gl_objects.hpp"

namespace iwalk {

Result<std::unique_ptr<TilePixels>> TilePixels::create(int width, int height) {
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (width > largest || height > largest)
        return fail(
            "a tile of {}x{} px is larger than this GL draws ({} px): cut the wall into smaller tiles", width,
            height, largest);
    std::unique_ptr<TilePixels> pixels(new TilePixels(width, height));
    pixels->color_ = makeTexture(GL_RGBA8, width, height);
    glCreateFramebuffers(1, &pixels->colorFramebuffer_);
    glNamedFramebufferTexture(pixels->colorFramebuffer_, GL_COLOR_ATTACHMENT0, pixels->color_, 0);
    if (glCheckNamedFramebufferStatus(pixels->colorFramebuffer_, GL_DRAW_FRAMEBUFFER) !=
        GL_FRAMEBUFFER_COMPLETE)
        return fail("this GL cannot draw {}x{} px", width, height);
    return pixels;
}

TilePixels::~TilePixels() {
    for (const GLuint texture : {color_, eyeDepth_}) glDeleteTextures(1, &texture);
    for (const GLuint framebuffer : {colorFramebuffer_, depthFramebuffer_})
        glDeleteFramebuffers(1, &framebuffer);
}

// Frames whose depth is wanted have a framebuffer of their own.
void TilePixels::addDepth() {
    eyeDepth_ = makeTexture(GL_R32F, width_, height_);
    glCreateFramebuffers(1, &depthFramebuffer_);
    glNamedFramebufferTexture(depthFramebuffer_, GL_COLOR_ATTACHMENT0, color_, 0);
    glNamedFramebufferTexture(depthFramebuffer_, GL_COLOR_ATTACHMENT1, eyeDepth_, 0);
    const GLenum targets[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glNamedFramebufferDrawBuffers(depthFramebuffer_, 2, targets);
}

void TilePixels::clear(std::uint32_t background, bool depth) {
    depth_ = depth;
    if (depth_ && depthFramebuffer_ == 0) addDepth();
    const auto channel = [&](int shift) { return static_cast<float>((background >> shift) & 255) / 255; };
    const float color[] = {channel(16), channel(8), channel(0), 1};
    const float nothing[] = {0, 0, 0, 0};
    glDisable(GL_SCISSOR_TEST);
    glClearNamedFramebufferfv(framebuffer(), GL_COLOR, 0, color);
    if (depth_) glClearNamedFramebufferfv(framebuffer(), GL_COLOR, 1, nothing);
}

ColorImage TilePixels::readColor() const {
    ColorImage image(width_, height_, 3);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, colorFramebuffer_);
    glReadPixels(0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, image.pixels.data());
    return image;
}

DepthImage TilePixels::readDepth() const {
    CHECK(depth_);
    DepthImage image(width_, height_, 1);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, depthFramebuffer_);
    glReadBuffer(GL_COLOR_ATTACHMENT1);
    glReadPixels(0, 0, width_, height_, GL_RED, GL_FLOAT, image.pixels.data());
    return image;
}

}  // namespace iwalk
