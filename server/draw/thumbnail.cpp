#include "server/draw/thumbnail.hpp"

#include <epoxy/gl.h>

#include <algorithm>

namespace iwalk {

Thumbnail::~Thumbnail() {
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteTextures(1, &texture_);
}

void Thumbnail::prepare(int width, int height, int levels) {
    if (width == width_ && height == height_ && levels == levels_) return;
    glDeleteTextures(1, &texture_);
    glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
    glTextureStorage2D(texture_, levels, GL_RGBA8, width, height);
    if (framebuffer_ == 0) glCreateFramebuffers(1, &framebuffer_);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
    width_ = width, height_ = height, levels_ = levels;
}

// First to less than half the size at most, so that no pixel is left out; then each step halves exactly.
ColorImage Thumbnail::read(std::uint32_t framebuffer, int width, int height, int smallWidth,
                           int smallHeight) {
    smallWidth = std::clamp(smallWidth, 1, width), smallHeight = std::clamp(smallHeight, 1, height);
    int halvings = 0;
    while (smallWidth << (halvings + 1) <= width && smallHeight << (halvings + 1) <= height) ++halvings;
    prepare(smallWidth << halvings, smallHeight << halvings, halvings + 1);

    glDisable(GL_SCISSOR_TEST);
    glBlitNamedFramebuffer(framebuffer, framebuffer_, 0, 0, width, height, 0, 0, width_, height_,
                           GL_COLOR_BUFFER_BIT, GL_LINEAR);
    if (halvings > 0) glGenerateTextureMipmap(texture_);
    ColorImage image(smallWidth, smallHeight, 3);
    glGetTextureImage(texture_, halvings, GL_RGB, GL_UNSIGNED_BYTE, static_cast<GLsizei>(image.pixels.size()),
                      image.pixels.data());
    return image;
}

}  // namespace iwalk
