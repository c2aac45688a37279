#include "server/draw/lines.hpp"

#include <epoxy/gl.h>

#include <vector>

#include "server/draw/shaders.hpp"

namespace iwalk {
namespace {

struct End {
    float place[3];
    std::uint32_t color;
    float behind;
};

}  // namespace

Lines::~Lines() {
    glDeleteProgram(program_);
    glDeleteVertexArrays(1, &array_);
    glDeleteBuffers(1, &buffer_);
}

Result<void> Lines::prepare() {
    ASSIGN_OR_RETURN(program_, compileLineProgram());
    glCreateVertexArrays(1, &array_);
    glCreateBuffers(1, &buffer_);
    glVertexArrayVertexBuffer(array_, 0, buffer_, 0, sizeof(End));
    glVertexArrayAttribFormat(array_, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribFormat(array_, 1, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(End, color));
    glVertexArrayAttribFormat(array_, 2, 1, GL_FLOAT, GL_FALSE, offsetof(End, behind));
    for (const GLuint attribute : {0u, 1u, 2u}) {
        glVertexArrayAttribBinding(array_, attribute, 0);
        glEnableVertexArrayAttrib(array_, attribute);
    }
    return {};
}

void Lines::use() const {
    glUseProgram(program_);
}

void Lines::draw(std::span<const Line> lines) const {
    std::vector<End> ends;
    for (const Line& line : lines)
        for (const glm::dvec3& end : {line.from, line.to})
            ends.push_back({{static_cast<float>(end.x), static_cast<float>(end.y), static_cast<float>(end.z)},
                            line.color,
                            line.behind});
    glNamedBufferData(buffer_, static_cast<GLsizeiptr>(ends.size() * sizeof(End)), ends.data(),
                      GL_STREAM_DRAW);
    glBindVertexArray(array_);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(ends.size()));
    glDisable(GL_BLEND);
}

}  // namespace iwalk
