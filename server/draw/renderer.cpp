// Tiles of one screen come out pixel by pixel as one big render would: all tiles use the screen's own
// projection, with window positions snapped in the vertex shader, and a viewport that begins whole pixels
// away (docs/architecture.md).

#include "server/draw/renderer.hpp"

#include <epoxy/gl.h>

#include <array>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "server/draw/arena_banks.hpp"
#include "server/draw/gl_objects.hpp"
#include "server/draw/shaders.hpp"
#include "server/draw/shading_variant.hpp"
#include "server/draw/visibility_buffer.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kMaxSlots = 65535;  // a slot and a triangle in a page fit in 32 bits, and 0 is free
constexpr int kTexelsOfPages = kMaxSlots * sizeof(ShadedPage) / 16;
constexpr std::uint32_t kNoBank = 0xffffffff;  // of pages that are not there any more

class GlRenderer : public Renderer {
  public:
    explicit GlRenderer(const SceneLook& look) : look_(look) {}
    ~GlRenderer() override;
    Result<void> prepare(std::span<const PixelRect> tiles);
    Result<void> setLook(const SceneLook& look) override;

    Result<std::vector<std::span<std::byte>>> lendArena(std::uint64_t bytes) override {
        ASSIGN_OR_RETURN(auto memory, makeArenaBanks(bytes, kArenaAlignment, banks_));
        for (const GLuint bank : banks_) bankTextures_.push_back(makeTextureBuffer(GL_RG32UI, bank));
        return memory;
    }
    void beginFrame(const TileView& view, TilePixels& pixels) override;
    void beginBlock(const Block& block) override;
    std::uint32_t draw(const ResidentPage& page, const PageRecord& record, std::uint32_t rank,
                       std::span<const DrawnRange> ranges) override;
    void beginRest() override;
    void finish() override;
    void drawLines(std::span<const Line> lines) override;
    void wait() override { glFinish(); }
    void readBlockDepths(DepthPyramid& depths) override;
    void readBlockTriangles(std::vector<std::uint32_t>& numbers) override;
    glm::ivec2 bindBlock() override;
    void sampleBlockDepths(std::vector<float>& depths) override {
        visible_.sampleDepths(inFramebuffer(), depths);
    }

  private:
    Result<void> prepareBlocks(std::span<const PixelRect> tiles);
    std::uint32_t addSlot(const ResidentPage& page, const PageRecord& record, const PageLayout& layout,
                          const glm::dvec3& origin, std::uint32_t rank);
    void addTints(const ResidentPage& page, std::span<const DrawnRange> ranges);
    // The block's part in its framebuffer.
    PixelRect inFramebuffer() const {
        return {block_.part.x - block_.x, block_.part.y - block_.y, block_.part.width, block_.part.height};
    }
    void startNumbersAgain();
    void useVisibilityProgram(bool wide);
    void useView(int x, int y) const;
    void bindPicture(GLuint framebuffer);
    void shade();
    void useShadingProgram();

    SceneLook look_;
    VisibilityBuffer visible_;
    Lines lines_;
    std::array<GLuint, 2> visibilityPrograms_{}, vertexArrays_{};  // narrow, wide
    GLuint emptyArray_ = 0;
    std::array<GLuint, kShadeVariants> shadingPrograms_{};
    std::vector<GLuint> banks_, bankTextures_;
    GLuint pagesBuffer_ = 0, pagesTexture_ = 0, tintsBuffer_ = 0;
    std::vector<ShadedPage> slots_;     // by slot: what was drawn in this block
    std::vector<std::uint32_t> tints_;  // of slots, as in ShadedPage::tints
    std::size_t unshaded_ = 0;          // slots from here on have not been shaded
    TileView view_;
    TilePixels* pixels_ = nullptr;  // of the view
    Block block_;
    GLuint used_ = 0;  // the visibility program that has this block's uniforms and is in use
};

GlRenderer::~GlRenderer() {
    for (const GLuint program : visibilityPrograms_) glDeleteProgram(program);
    for (const GLuint program : shadingPrograms_) glDeleteProgram(program);
    glDeleteTextures(1, &pagesTexture_);
    glDeleteTextures(static_cast<GLsizei>(bankTextures_.size()), bankTextures_.data());
    for (const GLuint array : {vertexArrays_[0], vertexArrays_[1], emptyArray_})
        glDeleteVertexArrays(1, &array);
    glDeleteBuffers(1, &pagesBuffer_);
    glDeleteBuffers(1, &tintsBuffer_);
    glDeleteBuffers(static_cast<GLsizei>(banks_.size()), banks_.data());
}

Result<void> GlRenderer::prepare(std::span<const PixelRect> tiles) {
    GLint texels = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    if (texels < kTexelsOfPages)
        return fail("this GL reads {} texels of a buffer; {} are wanted", texels, kTexelsOfPages);
    RETURN_IF_ERROR(prepareBlocks(tiles));
    RETURN_IF_ERROR(lines_.prepare());
    RETURN_IF_ERROR(compileVisibilityPrograms(visibilityPrograms_, look_.overdraw));
    for (const bool wide : {false, true}) vertexArrays_[wide] = makeVertexArray(wide ? 3 : 2);
    glCreateVertexArrays(1, &emptyArray_);
    glCreateBuffers(1, &pagesBuffer_);
    glCreateBuffers(1, &tintsBuffer_);
    glNamedBufferStorage(pagesBuffer_, kMaxSlots * sizeof(ShadedPage), nullptr, GL_DYNAMIC_STORAGE_BIT);
    pagesTexture_ = makeTextureBuffer(GL_RGBA32UI, pagesBuffer_);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDepthFunc(GL_GREATER);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    return {};
}

Result<void> GlRenderer::setLook(const SceneLook& look) {
    const bool counts = look.overdraw != look_.overdraw;
    look_ = look;
    if (!counts) return {};
    visible_.setCounts(look_.overdraw);
    return compileVisibilityPrograms(visibilityPrograms_, look_.overdraw);
}

Result<void> GlRenderer::prepareBlocks(std::span<const PixelRect> tiles) {
    int width = 0, height = 0;
    for (const PixelRect& tile : tiles)
        for (const Block& block : blocksOf(tile)) {
            width = std::max(width, block.part.x + block.part.width - block.x);
            height = std::max(height, block.part.y + block.part.height - block.y);
        }
    RETURN_IF_ERROR(visible_.prepare(width, height));
    visible_.setCounts(look_.overdraw);
    return {};
}

void GlRenderer::beginFrame(const TileView& view, TilePixels& pixels) {
    CHECK_OP(view.tile.width, ==, pixels.width());
    CHECK_OP(view.tile.height, ==, pixels.height());
    view_ = view;
    pixels_ = &pixels;
    pixels.clear(look_.background, view.captureDepth);
}

void GlRenderer::beginBlock(const Block& block) {
    block_ = block;
    used_ = 0;
    slots_.clear();
    tints_.clear();
    unshaded_ = 0;
    glDisable(GL_SCISSOR_TEST);
    visible_.clear();
}

void GlRenderer::useVisibilityProgram(bool wide) {
    if (used_ == visibilityPrograms_[wide]) return;
    used_ = visibilityPrograms_[wide];
    visible_.bind();
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_SCISSOR_TEST);
    glBindVertexArray(vertexArrays_[wide]);
    glUseProgram(used_);
    useView(block_.x, block_.y);
    const PixelRect part = inFramebuffer();
    glScissor(part.x, part.y, part.width, part.height);
}

// The view's uniforms and viewport, for a framebuffer that begins at (x, y) px of the screen.
void GlRenderer::useView(int x, int y) const {
    glUniformMatrix3fv(kToPixels, 1, GL_FALSE, glm::value_ptr(glm::mat3(view_.projection.toPixels)));
    glUniform1f(kNear, static_cast<float>(view_.near));
    const Window window = windowFor(view_.screenWidth, view_.screenHeight, block_);
    const float half = static_cast<float>(window.edge) / 2;
    glViewport(window.x - x, window.y - y, window.edge, window.edge);
    glUniform3f(kWindow, static_cast<float>(window.x) + half, static_cast<float>(window.y) + half, half);
}

std::uint32_t GlRenderer::draw(const ResidentPage& page, const PageRecord& record, std::uint32_t rank,
                               std::span<const DrawnRange> ranges) {
    if (slots_.size() == kMaxSlots) startNumbersAgain();
    const bool wide = record.flags & kPageWide;
    const PageLayout layout = pageLayout(record);
    const glm::dvec3 origin = view_.eye.to(page.table->origin);
    const std::uint32_t slot = addSlot(page, record, layout, origin, rank);
    if (look_.tints) addTints(page, ranges);

    useVisibilityProgram(wide);
    const GLuint buffer = banks_[page.place.bank];
    const auto offset = static_cast<GLintptr>(page.place.offset);
    glVertexArrayVertexBuffer(vertexArrays_[wide], 0, buffer, offset + layout.positions,
                              static_cast<GLsizei>(layout.positionStride));
    glVertexArrayElementBuffer(vertexArrays_[wide], buffer);
    glUniform3d(kPageOrigin, origin.x, origin.y, origin.z);
    for (const DrawnRange& range : ranges) {
        glUniform1ui(kFirstId, (slot + 1) << 16 | range.firstIndex / 3);
        glUniform1f(kNearest, std::min(range.box.depth, 1.0f));
        const std::uintptr_t at = static_cast<std::uintptr_t>(offset) + layout.indices + 2 * range.firstIndex;
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.indexCount), GL_UNSIGNED_SHORT,
                       reinterpret_cast<const void*>(at));
    }
    return slot;
}

void GlRenderer::addTints(const ResidentPage& page, std::span<const DrawnRange> ranges) {
    tints_.push_back(static_cast<std::uint32_t>(ranges.size()));
    for (const DrawnRange& range : ranges) {
        tints_.push_back(range.firstIndex / 3);
        tints_.push_back(look_.tints.of(page, range));
    }
}

// More pages than numbers: what was drawn so far keeps its depth and loses its place in the order.
void GlRenderer::startNumbersAgain() {
    shade();
    visible_.forgetNumbers();
    slots_.clear();
    tints_.clear();
    unshaded_ = 0;
}

void GlRenderer::beginRest() {
    bindBlock();
    visible_.beginRest();
}

glm::ivec2 GlRenderer::bindBlock() {
    const PixelRect part = inFramebuffer();
    visible_.bind();
    glEnable(GL_SCISSOR_TEST);
    glScissor(part.x, part.y, part.width, part.height);
    glEnable(GL_DEPTH_TEST);
    glViewport(part.x, part.y, part.width, part.height);
    used_ = 0;
    return {part.width, part.height};
}

void GlRenderer::readBlockDepths(DepthPyramid& depths) {
    const PixelRect part = inFramebuffer();
    depths.build(part.width, part.height, [&](int first, int rows, float* to) {
        visible_.readDepths({part.x, part.y + first, part.width, rows}, to);
    });
}

void GlRenderer::readBlockTriangles(std::vector<std::uint32_t>& numbers) {
    visible_.readNumbers(inFramebuffer(), numbers);
}

std::uint32_t GlRenderer::addSlot(const ResidentPage& page, const PageRecord& record,
                                  const PageLayout& layout, const glm::dvec3& origin, std::uint32_t rank) {
    const auto word = [&](std::uint32_t stream) {
        return static_cast<std::uint32_t>((page.place.offset + stream) / 4);
    };
    slots_.push_back(
        {{origin.x, origin.y, origin.z, 0},
         {word(layout.positions), word(layout.colors), word(layout.normals), word(layout.indices)},
         page.place.bank,
         record.flags & kPageWide ? 1u : 0u,
         rank,
         static_cast<std::uint32_t>(tints_.size())});
    return static_cast<std::uint32_t>(slots_.size() - 1);
}

void GlRenderer::finish() {
    shade();
    glFinish();
}

// The block's part of the tile, to draw to, and its visibility buffer, to read.
void GlRenderer::bindPicture(GLuint framebuffer) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_SCISSOR_TEST);
    glScissor(block_.part.x - view_.tile.x, block_.part.y - view_.tile.y, block_.part.width,
              block_.part.height);
    visible_.bindForShading();
}

// Every pixel whose nearest surface was drawn since the last time gets its colour, while the pages are still
// there. A pixel that a later batch covers is shaded again then.
void GlRenderer::shade() {
    if (unshaded_ == slots_.size()) return;
    glNamedBufferSubData(pagesBuffer_, 0, static_cast<GLsizeiptr>(slots_.size() * sizeof(ShadedPage)),
                         slots_.data());
    bindPicture(pixels_->framebuffer());
    glViewport(0, 0, pixels_->width(), pixels_->height());
    glBindVertexArray(emptyArray_);
    glBindTextureUnit(kPagesUnit, pagesTexture_);
    if (look_.tints) {
        glNamedBufferData(tintsBuffer_, static_cast<GLsizeiptr>(4 * tints_.size()), tints_.data(),
                          GL_STREAM_DRAW);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kTintsBinding, tintsBuffer_);
    }
    useShadingProgram();
    std::vector<bool> used(banks_.size());
    for (; unshaded_ < slots_.size(); ++unshaded_) {
        used[slots_[unshaded_].bank] = true;
        slots_[unshaded_].bank = kNoBank;  // next time
    }
    for (std::uint32_t bank = 0; bank < banks_.size(); ++bank) {
        if (!used[bank]) continue;
        glBindTextureUnit(kPairsUnit, bankTextures_[bank]);
        glUniform1ui(kBank, bank);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    glDisable(GL_SCISSOR_TEST);
    used_ = 0;
}

void GlRenderer::drawLines(std::span<const Line> lines) {
    bindPicture(pixels_->colorFramebuffer());
    lines_.use();
    useView(view_.tile.x, view_.tile.y);
    glUniform2i(kInBlock, view_.tile.x - block_.x, view_.tile.y - block_.y);
    lines_.draw(lines);
    glDisable(GL_SCISSOR_TEST);
    used_ = 0;
}

void GlRenderer::useShadingProgram() {
    const std::uint32_t variant = shadingVariant(look_, view_.captureDepth, visible_.hasRest());
    if (shadingPrograms_[variant] == 0) {
        Result<std::uint32_t> program = compileShadingProgram(variant);
        if (!program) detail::checkFailed(__FILE__, __LINE__, program.error().message);
        shadingPrograms_[variant] = *program;
    }
    glUseProgram(shadingPrograms_[variant]);
    glUniformMatrix3fv(kToPixels, 1, GL_FALSE, glm::value_ptr(glm::mat3(view_.projection.toPixels)));
    glUniformMatrix3fv(kToDirection, 1, GL_FALSE, glm::value_ptr(glm::mat3(view_.projection.toDirection)));
    glUniform1f(kNear, static_cast<float>(view_.near));
    glUniform2f(kTileOrigin, static_cast<float>(view_.tile.x), static_cast<float>(view_.tile.y));
    glUniform2i(kInBlock, view_.tile.x - block_.x, view_.tile.y - block_.y);
    if (variant & kShadeDepth)
        glUniform1f(kStepSize, static_cast<float>(std::ldexp(1.0, look_.stepExponent)));
    if (variant & kShadeRamp) {
        const double low = view_.eye.to(look_.bounds.min).z;
        // Where all is flat, floats must not colour it.
        const glm::dvec3 sides(look_.bounds.max - look_.bounds.min);
        const double height = std::max({1.0, sides.z, 0x1p-12 * sides.x, 0x1p-12 * sides.y});
        glUniform2f(kRamp, static_cast<float>(low), static_cast<float>(1 / height));
    }
}

}  // namespace

Result<std::unique_ptr<Renderer>> Renderer::create(std::span<const PixelRect> tiles, const SceneLook& look) {
    auto renderer = std::make_unique<GlRenderer>(look);
    RETURN_IF_ERROR(renderer->prepare(tiles));
    return std::unique_ptr<Renderer>(std::move(renderer));
}

}  // namespace iwalk
