#include "tests/bench/plp/owners.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "server/draw/shaders.hpp"

namespace iwalk::bench {
namespace {

GLuint makeTarget(GLenum format, int width, int height) {
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, width, height);
    return texture;
}

}  // namespace

Result<CutPages> loadPages(const Dataset& dataset, const Cut& cut) {
    ASSIGN_OR_RETURN(const PageFiles files, openPageFiles(dataset.path, dataset.manifest));
    const Hierarchy& hierarchy = dataset.hierarchy;
    CutPages pages;
    pages.tables.resize(hierarchy.pages.size());
    pages.decoded.resize(hierarchy.pages.size());
    std::vector<std::byte> bytes;
    for (const std::uint32_t index : cut.entry) {
        if (index == Cut::kNothing) continue;
        const LevelRecord& entry = hierarchy.entries[index];
        for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page) {
            if (!pages.decoded[page].empty()) continue;
            const PageRecord& record = hierarchy.pages[page];
            bytes.resize(record.bytes);
            RETURN_IF_ERROR(files[record.file]->readAt(record.offset, bytes));
            pages.decoded[page].resize(pageLayout(record).bytes);
            ASSIGN_OR_RETURN(pages.tables[page], decodePage(bytes, record, pages.decoded[page]));
        }
    }
    return pages;
}

OwnerRenders::OwnerRenders(const Dataset& dataset, const Cut& cut, const CutPages& pages, int width,
                           int height)
    : dataset_(dataset), cut_(cut), pages_(pages), width_(width), height_(height) {
    std::uint32_t next = 1;
    for (const PageRecord& page : dataset.hierarchy.pages) {
        firstTriangle_.push_back(next);
        next += page.indexCount / 3;
    }
    buffers_.resize(dataset.hierarchy.pages.size());
}

OwnerRenders::~OwnerRenders() {
    glDeleteBuffers(static_cast<GLsizei>(buffers_.size()), buffers_.data());
    glDeleteFramebuffers(1, &framebuffer_);
    for (const GLuint texture : {ids_, depth_}) glDeleteTextures(1, &texture);
    for (const int wide : {0, 1}) {
        glDeleteProgram(programs_[wide]);
        glDeleteVertexArrays(1, &arrays_[wide]);
    }
}

Result<std::unique_ptr<OwnerRenders>> OwnerRenders::create(const Dataset& dataset, const Cut& cut,
                                                           const CutPages& pages, int width, int height) {
    std::unique_ptr<OwnerRenders> made(new OwnerRenders(dataset, cut, pages, width, height));
    RETURN_IF_ERROR(compileVisibilityPrograms(made->programs_, false));
    for (const std::size_t wide : {std::size_t{0}, std::size_t{1}}) {
        GLuint& array = made->arrays_[wide];
        glCreateVertexArrays(1, &array);
        glEnableVertexArrayAttrib(array, 0);
        glVertexArrayAttribIFormat(array, 0, wide ? 3 : 2, GL_UNSIGNED_INT, 0);
        glVertexArrayAttribBinding(array, 0, 0);
    }
    made->ids_ = makeTarget(GL_R32UI, width, height);
    made->depth_ = makeTarget(GL_DEPTH_COMPONENT32F, width, height);
    glCreateFramebuffers(1, &made->framebuffer_);
    glNamedFramebufferTexture(made->framebuffer_, GL_COLOR_ATTACHMENT0, made->ids_, 0);
    glNamedFramebufferTexture(made->framebuffer_, GL_DEPTH_ATTACHMENT, made->depth_, 0);
    return made;
}

std::vector<std::vector<Owned>> OwnerRenders::draw(const Wall& wall, const Camera& camera) {
    const ScreenProjection projection = projectScreen(wall.screens(camera.fovY)[0], camera);
    const int step = dataset_.manifest.stepExponent;
    const LatticeEye eye = LatticeEye::at(camera.eye, step);
    const double near = std::ldexp(nearPlane({}, dataset_.manifest), -step);
    const Frustum frustum = frustumOf(projection, {0, 0, width_, height_}, 1, near);

    glDisable(GL_SCISSOR_TEST);
    begin(projection, near);
    std::vector<Range> drawn;
    for (const VisibleRanges& ranges : FrustumVisibility(dataset_.hierarchy).visible(cut_, frustum, eye)) {
        const PageTable& table = pages_.tables[ranges.page];
        drawn.clear();
        forRangesIn(
            table, ranges.firstRange, ranges.rangeCount, frustum, eye,
            [&](std::uint32_t r, const glm::dvec3&, const glm::dvec3&) { drawn.push_back(table.ranges[r]); });
        drawPage(dataset_.hierarchy.pages[ranges.page], ranges.page, eye, drawn);
    }

    std::vector<std::uint32_t> ids(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width_, height_, GL_RED_INTEGER, GL_UNSIGNED_INT, ids.data());
    std::vector<std::vector<Owned>> owned;
    for (const Tile& tile : wall.tiles) owned.push_back(countTile(tile.onScreen, ids));
    return owned;
}

void OwnerRenders::depthsOf(const TileSight& sight, const std::vector<VisibleRanges>& chosen,
                            DepthPyramid& depths) {
    const PixelRect& tile = sight.tile;
    glEnable(GL_SCISSOR_TEST);
    glScissor(tile.x, tile.y, tile.width, tile.height);
    begin(sight.projection, sight.near);
    for (const VisibleRanges& some : chosen) {
        const auto& ranges = pages_.tables[some.page].ranges;
        const auto first = ranges.begin() + some.firstRange;
        drawPage(dataset_.hierarchy.pages[some.page], some.page, sight.eye, {first, first + some.rangeCount});
    }
    depths.build(tile.width, tile.height, [&](int first, int rows, float* to) {
        glReadPixels(tile.x, tile.y + first, tile.width, rows, GL_DEPTH_COMPONENT, GL_FLOAT, to);
    });
}

// Within the scissor.
void OwnerRenders::begin(const ScreenProjection& projection, double near) {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    const GLuint nobody[] = {0, 0, 0, 0};
    const float far[] = {0};
    glClearNamedFramebufferuiv(framebuffer_, GL_COLOR, 0, nobody);
    glClearNamedFramebufferfv(framebuffer_, GL_DEPTH, 0, far);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glDepthFunc(GL_GREATER);
    glEnable(GL_DEPTH_TEST);
    const int edge = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(width_, height_))));
    glViewport(0, 0, edge, edge);
    const float half = static_cast<float>(edge) / 2;
    for (const GLuint program : programs_) {
        glProgramUniformMatrix3fv(program, kToPixels, 1, GL_FALSE,
                                  glm::value_ptr(glm::mat3(projection.toPixels)));
        glProgramUniform1f(program, kNear, static_cast<float>(near));
        glProgramUniform3f(program, kWindow, half, half, half);
    }
    used_ = 0;
}

void OwnerRenders::drawPage(const PageRecord& record, std::uint32_t page, const LatticeEye& eye,
                            const std::vector<Range>& ranges) {
    const bool wide = record.flags & kPageWide;
    const PageLayout layout = pageLayout(record);
    if (buffers_[page] == 0) {
        glCreateBuffers(1, &buffers_[page]);
        glNamedBufferStorage(buffers_[page], layout.bytes, pages_.decoded[page].data(), 0);
    }
    if (used_ != programs_[wide]) {
        used_ = programs_[wide];
        glUseProgram(used_);
        glBindVertexArray(arrays_[wide]);
    }
    glVertexArrayVertexBuffer(arrays_[wide], 0, buffers_[page], layout.positions,
                              static_cast<GLsizei>(layout.positionStride));
    glVertexArrayElementBuffer(arrays_[wide], buffers_[page]);
    const glm::dvec3 origin = eye.to(pages_.tables[page].origin);
    glUniform3d(kPageOrigin, origin.x, origin.y, origin.z);
    for (const Range& run : ranges) {
        glUniform1ui(kFirstId, firstTriangle_[page] + run.firstIndex / 3);
        const std::uintptr_t at = std::uintptr_t{layout.indices} + 2 * run.firstIndex;
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(run.indexCount), GL_UNSIGNED_SHORT,
                       reinterpret_cast<const void*>(at));
    }
}

std::vector<Owned> OwnerRenders::countTile(const PixelRect& tile,
                                           const std::vector<std::uint32_t>& ids) const {
    std::vector<std::uint32_t> seen;
    for (int y = tile.y; y < tile.y + tile.height; ++y)
        for (int x = tile.x; x < tile.x + tile.width; ++x)
            if (const std::uint32_t id = ids[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                             static_cast<std::size_t>(x)])
                seen.push_back(id);
    std::sort(seen.begin(), seen.end());
    std::vector<Owned> owned;
    std::uint32_t page = 0, lastOfRange = 0;
    for (const std::uint32_t id : seen) {
        if (id > lastOfRange || owned.empty()) {
            page = static_cast<std::uint32_t>(
                std::upper_bound(firstTriangle_.begin() + page, firstTriangle_.end(), id) -
                firstTriangle_.begin() - 1);
            const std::uint32_t index = 3 * (id - firstTriangle_[page]);
            const auto& ranges = pages_.tables[page].ranges;
            const auto range =
                std::upper_bound(ranges.begin(), ranges.end(), index,
                                 [](std::uint32_t i, const Range& r) { return i < r.firstIndex; }) -
                1;
            lastOfRange = firstTriangle_[page] + (range->firstIndex + range->indexCount) / 3 - 1;
            owned.push_back({page, static_cast<std::uint32_t>(range - ranges.begin()), 0});
        }
        ++owned.back().pixels;
    }
    return owned;
}

}  // namespace iwalk::bench
