#include "tests/bench/visibility/item_buffer.hpp"

#include <epoxy/gl.h>

#include <algorithm>

#include "common/check.hpp"

namespace iwalk::bench {
namespace {

const char* const kVertex = R"(#version 450 core
struct Box { vec4 corners; float depth; uint number; };
layout(std430, binding = 0) readonly buffer Boxes { Box boxes[]; };
flat out uint number;
void main() {
    Box box = boxes[gl_InstanceID];
    number = box.number;
    gl_Position = vec4((gl_VertexID & 1) == 0 ? box.corners.x : box.corners.z,
                       gl_VertexID < 2 ? box.corners.y : box.corners.w, box.depth, 1.0);
}
)";
const char* const kFragment = R"(#version 450 core
flat in uint number;
layout(location = 0) out uint owner;
void main() { owner = number; }
)";

struct Item {
    float corners[4];
    float depth;
    std::uint32_t number;
    float unused[2];
};

GLuint compile() {
    const GLuint program = glCreateProgram();
    for (const auto& [stage, text] :
         {std::pair(GL_VERTEX_SHADER, kVertex), {GL_FRAGMENT_SHADER, kFragment}}) {
        const GLuint shader = glCreateShader(static_cast<GLenum>(stage));
        glShaderSource(shader, 1, &text, nullptr);
        glCompileShader(shader);
        glAttachShader(program, shader);
        glDeleteShader(shader);
    }
    glLinkProgram(program);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    CHECK(linked);
    return program;
}

class ItemBuffer : public Occlusion {
  public:
    explicit ItemBuffer(Renderer& renderer) : renderer_(renderer), program_(compile()) {
        glCreateVertexArrays(1, &emptyArray_);
        glCreateBuffers(1, &items_);
        glCreateFramebuffers(1, &framebuffer_);
    }
    ~ItemBuffer() override {
        glDeleteProgram(program_);
        glDeleteVertexArrays(1, &emptyArray_);
        glDeleteBuffers(1, &items_);
        glDeleteFramebuffers(1, &framebuffer_);
        for (const GLuint texture : {owners_, depths_}) glDeleteTextures(1, &texture);
    }
    void update() override;
    void hidden(std::span<const ScreenBox> boxes, std::vector<std::uint8_t>& hidden) override;

  private:
    void makeTextures();
    bool round(std::vector<Item>& open, std::vector<std::uint8_t>& hidden);

    Renderer& renderer_;
    const GLuint program_;
    GLuint emptyArray_ = 0, items_ = 0, framebuffer_ = 0, owners_ = 0, depths_ = 0;
    glm::ivec2 size_{0};
    std::vector<std::uint32_t> pixels_;
};

void ItemBuffer::update() {
    const glm::ivec2 size = renderer_.bindBlock();
    GLint drawn = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn);
    if (size != size_) {
        size_ = size;
        makeTextures();
    }
    glBlitNamedFramebuffer(static_cast<GLuint>(drawn), framebuffer_, 0, 0, size.x, size.y, 0, 0, size.x,
                           size.y, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
}

void ItemBuffer::makeTextures() {
    for (const GLuint texture : {owners_, depths_}) glDeleteTextures(1, &texture);
    glCreateTextures(GL_TEXTURE_2D, 1, &owners_);
    glTextureStorage2D(owners_, 1, GL_R32UI, size_.x, size_.y);
    glCreateTextures(GL_TEXTURE_2D, 1, &depths_);
    glTextureStorage2D(depths_, 1, GL_DEPTH_COMPONENT32F, size_.x, size_.y);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, owners_, 0);
    glNamedFramebufferTexture(framebuffer_, GL_DEPTH_ATTACHMENT, depths_, 0);
}

void ItemBuffer::hidden(std::span<const ScreenBox> boxes, std::vector<std::uint8_t>& hidden) {
    hidden.assign(boxes.size(), 1);
    std::vector<Item> open;
    const auto clip = [](int pixel, int pixels) {
        return 2 * static_cast<float>(pixel) / static_cast<float>(pixels) - 1;
    };
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const ScreenBox& box = boxes[i];
        if (box.empty()) continue;
        if (box.depth > 1)
            hidden[i] = 0;
        else
            open.push_back({{clip(box.left, size_.x), clip(box.top, size_.y), clip(box.right, size_.x),
                             clip(box.bottom, size_.y)},
                            box.depth,
                            static_cast<std::uint32_t>(i + 1),
                            {}});
    }
    renderer_.bindBlock();  // sets the viewport
    glDepthFunc(GL_GEQUAL);
    glDepthMask(GL_FALSE);
    while (!open.empty() && round(open, hidden)) {
    }
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
}

bool ItemBuffer::round(std::vector<Item>& open, std::vector<std::uint8_t>& hidden) {
    const GLuint nobody[] = {0, 0, 0, 0};
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glClearNamedFramebufferuiv(framebuffer_, GL_COLOR, 0, nobody);
    glNamedBufferData(items_, static_cast<GLsizeiptr>(open.size() * sizeof(Item)), open.data(),
                      GL_STREAM_DRAW);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, items_);
    glBindVertexArray(emptyArray_);
    glUseProgram(program_);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(open.size()));
    pixels_.resize(static_cast<std::size_t>(size_.x * size_.y));
    glReadPixels(0, 0, size_.x, size_.y, GL_RED_INTEGER, GL_UNSIGNED_INT, pixels_.data());
    for (const std::uint32_t owner : pixels_)
        if (owner != 0) hidden[owner - 1] = 0;
    return std::erase_if(open, [&](const Item& item) { return !hidden[item.number - 1]; }) > 0;
}

}  // namespace

std::unique_ptr<Occlusion> makeItemBuffer(Renderer& renderer) {
    return std::make_unique<ItemBuffer>(renderer);
}

}  // namespace iwalk::bench
