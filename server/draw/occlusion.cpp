#include "server/draw/occlusion.hpp"

#include <epoxy/gl.h>

#include "server/draw/shaders.hpp"
#include "server/visibility/depth_pyramid.hpp"

namespace iwalk {
namespace {

class DepthOcclusion : public Occlusion {
  public:
    DepthOcclusion(Renderer& renderer, Workers& workers) : renderer_(renderer), workers_(workers) {}
    void update() override { renderer_.readBlockDepths(pyramid_); }
    void hidden(std::span<const ScreenBox> boxes, std::vector<std::uint8_t>& hidden) override {
        hidden.resize(boxes.size());
        workers_.runParts(boxes.size(), kTogether, [&](std::size_t first, std::size_t end) {
            for (std::size_t i = first; i < end; ++i) hidden[i] = pyramid_.hides(boxes[i]);
        });
    }

  private:
    static constexpr std::size_t kTogether = 256;  // boxes that a thread tests at a time
    Renderer& renderer_;
    Workers& workers_;
    DepthPyramid pyramid_;
};

class QueryOcclusion : public Occlusion {
  public:
    QueryOcclusion(Renderer& renderer, GLuint program) : renderer_(renderer), program_(program) {
        glCreateVertexArrays(1, &emptyArray_);
    }
    ~QueryOcclusion() override {
        glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
        glDeleteVertexArrays(1, &emptyArray_);
        glDeleteProgram(program_);
    }
    void update() override {}  // the GL sees all that was drawn
    void hidden(std::span<const ScreenBox> boxes, std::vector<std::uint8_t>& hidden) override;

  private:
    void ask(const ScreenBox& box, GLuint query, const glm::ivec2& size) const;

    Renderer& renderer_;
    const GLuint program_;
    GLuint emptyArray_ = 0;
    std::vector<GLuint> queries_;  // made once, used again and again
};

void QueryOcclusion::hidden(std::span<const ScreenBox> boxes, std::vector<std::uint8_t>& hidden) {
    if (const std::size_t had = queries_.size(); had < boxes.size()) {
        queries_.resize(boxes.size());
        glCreateQueries(GL_ANY_SAMPLES_PASSED, static_cast<GLsizei>(boxes.size() - had),
                        queries_.data() + had);
    }
    const glm::ivec2 size = renderer_.bindBlock();
    glDepthFunc(GL_GEQUAL);  // a surface as near as the box hides nothing
    glDepthMask(GL_FALSE);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glBindVertexArray(emptyArray_);
    glUseProgram(program_);
    const auto asked = [&](std::size_t i) { return !boxes[i].empty() && boxes[i].depth <= 1; };
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (asked(i)) ask(boxes[i], queries_[i], size);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);

    hidden.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        GLuint passed = boxes[i].empty() ? 0 : 1;
        if (asked(i)) glGetQueryObjectuiv(queries_[i], GL_QUERY_RESULT, &passed);
        hidden[i] = passed == 0;
    }
}

void QueryOcclusion::ask(const ScreenBox& box, GLuint query, const glm::ivec2& size) const {
    const auto clip = [](int pixel, int pixels) {
        return 2 * static_cast<float>(pixel) / static_cast<float>(pixels) - 1;
    };
    glUniform4f(kBoxCorners, clip(box.left, size.x), clip(box.top, size.y), clip(box.right, size.x),
                clip(box.bottom, size.y));
    glUniform1f(kNearest, box.depth);
    glBeginQuery(GL_ANY_SAMPLES_PASSED, query);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    glEndQuery(GL_ANY_SAMPLES_PASSED);
}

}  // namespace

std::unique_ptr<Occlusion> makeDepthOcclusion(Renderer& renderer, Workers& workers) {
    return std::make_unique<DepthOcclusion>(renderer, workers);
}

Result<std::unique_ptr<Occlusion>> makeQueryOcclusion(Renderer& renderer) {
    ASSIGN_OR_RETURN(const GLuint program, compileBoxProgram());
    return std::unique_ptr<Occlusion>(std::make_unique<QueryOcclusion>(renderer, program));
}

Result<std::unique_ptr<Occlusion>> makeOcclusion(OcclusionTest test, Renderer& renderer, Workers& workers) {
    if (test == OcclusionTest::queries) return makeQueryOcclusion(renderer);
    return makeDepthOcclusion(renderer, workers);
}

}  // namespace iwalk
