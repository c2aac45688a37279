#include "server/draw/visibility_buffer.hpp"

#include <epoxy/gl.h>

#include <algorithm>

#include "server/draw/gl_objects.hpp"
#include "server/draw/shaders.hpp"

namespace iwalk {
namespace {

constexpr GLuint kNobody[] = {0, 0, 0, 0};
constexpr GLfloat kInfinitelyFar[] = {0};
constexpr int kSampledRows = 8;

std::size_t pixelsOf(const PixelRect& part) {
    return static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height);
}

}  // namespace

VisibilityBuffer::~VisibilityBuffer() {
    for (const Layer& layer : layers_) {
        glDeleteFramebuffers(1, &layer.framebuffer);
        glDeleteTextures(1, &layer.numbers);
        glDeleteTextures(1, &layer.depths);
    }
    glDeleteProgram(restProgram_);
    glDeleteTextures(1, &counts_);
    glDeleteVertexArrays(1, &emptyArray_);
}

Result<void> VisibilityBuffer::prepare(int width, int height) {
    width_ = width, height_ = height;
    for (Layer& layer : layers_) RETURN_IF_ERROR(prepare(layer, width, height));
    ASSIGN_OR_RETURN(restProgram_, compileRestProgram());
    glCreateVertexArrays(1, &emptyArray_);
    return {};
}

void VisibilityBuffer::setCounts(bool counts) {
    glDeleteTextures(1, &counts_);
    counts_ = counts ? makeTexture(GL_R32UI, width_, height_) : 0;
}

Result<void> VisibilityBuffer::prepare(Layer& layer, int width, int height) {
    layer.numbers = makeTexture(GL_R32UI, width, height);
    layer.depths = makeTexture(GL_DEPTH_COMPONENT32F, width, height);
    glCreateFramebuffers(1, &layer.framebuffer);
    glNamedFramebufferTexture(layer.framebuffer, GL_COLOR_ATTACHMENT0, layer.numbers, 0);
    glNamedFramebufferTexture(layer.framebuffer, GL_DEPTH_ATTACHMENT, layer.depths, 0);
    if (glCheckNamedFramebufferStatus(layer.framebuffer, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return fail("this GL cannot draw {}x{} px with 32-bit float depth", width, height);
    return {};
}

void VisibilityBuffer::clear() {
    rest_ = false;
    if (counts_ != 0) {
        glClearTexImage(counts_, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
        glBindImageTexture(kCountsBinding, counts_, 0, GL_FALSE, 0, GL_READ_WRITE, GL_R32UI);
    }
    glClearNamedFramebufferuiv(layers_[0].framebuffer, GL_COLOR, 0, kNobody);
    glClearNamedFramebufferfv(layers_[0].framebuffer, GL_DEPTH, 0, kInfinitelyFar);
}

void VisibilityBuffer::beginRest() {
    CHECK(!rest_);
    rest_ = true;
    bind();
    glDepthFunc(GL_ALWAYS);
    glBindVertexArray(emptyArray_);
    glUseProgram(restProgram_);
    glBindTextureUnit(0, layers_[0].depths);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthFunc(GL_GREATER);
}

void VisibilityBuffer::forgetNumbers() {
    for (const Layer& layer : layers_) glClearNamedFramebufferuiv(layer.framebuffer, GL_COLOR, 0, kNobody);
}

void VisibilityBuffer::bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, layers_[rest_].framebuffer);
}

void VisibilityBuffer::bindForShading() const {
    if (counts_ != 0) glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    for (GLuint i = 0; i < 2; ++i) {
        glBindTextureUnit(2 * i, layers_[i].numbers);
        glBindTextureUnit(2 * i + 1, layers_[i].depths);
    }
}

void VisibilityBuffer::readDepths(const PixelRect& part, float* depths) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, layers_[rest_].framebuffer);
    glReadPixels(part.x, part.y, part.width, part.height, GL_DEPTH_COMPONENT, GL_FLOAT, depths);
}

void VisibilityBuffer::sampleDepths(const PixelRect& part, std::vector<float>& depths) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, layers_[rest_].framebuffer);
    const int rows = std::min(kSampledRows, part.height);
    for (int i = 0; i < rows; ++i) {
        const std::size_t before = depths.size();
        depths.resize(before + static_cast<std::size_t>(part.width));
        glReadPixels(part.x, part.y + (2 * i + 1) * part.height / (2 * rows), part.width, 1,
                     GL_DEPTH_COMPONENT, GL_FLOAT, depths.data() + before);
    }
}

// Some rows at a time, which stay in the processor's cache: half of the time of reading all of both layers.
void VisibilityBuffer::readNumbers(const PixelRect& part, std::vector<std::uint32_t>& numbers) const {
    constexpr int kRows = 64;
    numbers.resize(pixelsOf(part));
    std::vector<std::uint32_t> later(rest_ ? pixelsOf({0, 0, part.width, kRows}) : 0);
    for (int y = 0; y < part.height; y += kRows) {
        const int rows = std::min(kRows, part.height - y);
        std::uint32_t* const to = numbers.data() + pixelsOf({0, 0, part.width, y});
        const auto read = [&](const Layer& layer, std::uint32_t* pixels) {
            glBindFramebuffer(GL_READ_FRAMEBUFFER, layer.framebuffer);
            glReadPixels(part.x, part.y + y, part.width, rows, GL_RED_INTEGER, GL_UNSIGNED_INT, pixels);
        };
        read(layers_[0], to);
        if (!rest_) continue;
        read(layers_[1], later.data());
        const std::size_t count = pixelsOf({0, 0, part.width, rows});
        for (std::size_t i = 0; i < count; ++i) to[i] = later[i] != 0 ? later[i] : to[i];
    }
}

}  // namespace iwalk
