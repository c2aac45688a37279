#include "server/draw/arena_banks.hpp"

#include <epoxy/gl.h>

#include <algorithm>

#include "common/settings.hpp"

namespace iwalk {
namespace {

// One GL buffer at the most; offsets into it must fit in 31 bits.
constexpr std::uint64_t kMaxBankBytes = std::uint64_t{1} << 30;

}  // namespace

Result<std::vector<std::span<std::byte>>> makeArenaBanks(std::uint64_t bytes, std::uint64_t alignment,
                                                         std::vector<std::uint32_t>& banks) {
    GLint texels = 0;  // of 8 bytes, that the second pass can read of a buffer
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    const std::uint64_t bank =
        std::min(kMaxBankBytes, 8 * static_cast<std::uint64_t>(texels)) / alignment * alignment;
    constexpr GLbitfield kAccess =
        GL_MAP_WRITE_BIT | GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    std::vector<std::span<std::byte>> memory;
    bytes = std::max(bytes, alignment);
    for (std::uint64_t left = (bytes + alignment - 1) / alignment * alignment; left > 0;) {
        const std::uint64_t size = std::min(left, bank);
        GLuint buffer = 0;
        glCreateBuffers(1, &buffer);
        banks.push_back(buffer);
        glNamedBufferStorage(buffer, static_cast<GLsizeiptr>(size), nullptr, kAccess);
        void* mapped = glMapNamedBufferRange(buffer, 0, static_cast<GLsizeiptr>(size), kAccess);
        if (!mapped)
            return fail("the GL has no {} for the geometry cache: lower --cache", formatBytes(bytes));
        memory.emplace_back(static_cast<std::byte*>(mapped), size);
        left -= size;
    }
    return memory;
}

}  // namespace iwalk
