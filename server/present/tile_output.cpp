#include "server/present/tile_output.hpp"

#include <epoxy/gl.h>

namespace iwalk {

TileOutput::TileOutput(const Tile& tile, WallWindow* window)
    : width_(tile.onScreen.width), height_(tile.onScreen.height), window_(window) {
    glCreateFramebuffers(1, &framebuffer_);
}

TileOutput::~TileOutput() {
    glDeleteFramebuffers(1, &framebuffer_);
}

Result<std::unique_ptr<TileOutput>> TileOutput::create(const Tile& tile, WallWindow* window) {
    std::unique_ptr<TileOutput> output(new TileOutput(tile, window));
    if (tile.blend.any()) {
        ASSIGN_OR_RETURN(output->blend_, BlendPass::create(output->width_, output->height_, tile.blend));
    }
    return output;
}

void TileOutput::prepare(std::uint32_t drawn) {
    shown_ = blend_ ? blend_->apply(drawn) : drawn;
    glFinish();  // what is left to do after the barrier is the same short work for all
}

void TileOutput::show() {
    if (window_) window_->show(shown_);
}

ColorImage TileOutput::read() const {
    ColorImage image(width_, height_, 3);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, shown_, 0);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, image.pixels.data());
    return image;
}

bool TileOutput::closed() {
    return window_ && window_->closed();
}

}  // namespace iwalk
