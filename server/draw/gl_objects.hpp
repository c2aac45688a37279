#pragma once

#include <epoxy/gl.h>

namespace iwalk {

// Of one level; read pixel by pixel.
inline GLuint makeTexture(GLenum format, int width, int height) {
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, width, height);
    // Without this integers cannot be read, since they cannot be filtered.
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTextureParameteri(texture, filter, GL_NEAREST);
    return texture;
}

// Reads a buffer.
inline GLuint makeTextureBuffer(GLenum format, GLuint buffer) {
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &texture);
    glTextureBuffer(texture, format, buffer);
    return texture;
}

// Of positions: unsigned integers from one buffer.
inline GLuint makeVertexArray(GLint components) {
    GLuint array = 0;
    glCreateVertexArrays(1, &array);
    glEnableVertexArrayAttrib(array, 0);
    glVertexArrayAttribIFormat(array, 0, components, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(array, 0, 0);
    return array;
}

}  // namespace iwalk
