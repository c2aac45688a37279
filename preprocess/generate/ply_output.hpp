#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/file.hpp"

namespace iwalk {

using Rgb = std::array<std::uint8_t, 3>;  // sRGB

// What vertices of a file have.
struct VertexLayout {
    bool colors = false;
    bool doubles = false;  // positions of 64 bits, not 32
};

// A binary little-endian PLY file, written front to back: all vertices, then all triangles. Their counts,
// which the header has before both, are put in at the end, into room left by a comment. The file has a
// temporary name until finish(); without finish() nothing is left.
class PlyOutput {
  public:
    // `note` becomes a comment in the header, one line.
    static Result<std::unique_ptr<PlyOutput>> create(const std::string& path, VertexLayout layout,
                                                     const std::string& note);
    ~PlyOutput();
    PlyOutput(const PlyOutput&) = delete;
    PlyOutput& operator=(const PlyOutput&) = delete;

    // An error shows in status(); until somebody looks, what comes after it is dropped. Positions have the
    // type that the layout says.
    void vertex(const glm::vec3& position, Rgb color = {}) { vertexOf(position, color); }
    void vertex(const glm::dvec3& position) { vertexOf(position, {}); }
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        std::byte* at = room(13);
        const std::array<std::uint32_t, 3> corners{a, b, c};
        *at = std::byte{3};
        std::memcpy(at + 1, corners.data(), 12);
        used_ += 13;
        ++triangles_;
    }
    Result<void> status() const;
    // Writes the counts, syncs, and renames to the real name.
    Result<void> finish();

    std::string directory() const;  // that the file is in
    std::uint64_t vertices() const { return vertices_; }
    std::uint64_t triangles() const { return triangles_; }
    std::uint64_t bytes() const { return file_.size() + used_; }

  private:
    PlyOutput(std::string path, OutputFile file, VertexLayout layout, std::string note);
    template <class Position>
    void vertexOf(const Position& position, Rgb color) {
        std::byte* at = room(sizeof position + 3);
        std::memcpy(at, &position, sizeof position);
        if (layout_.colors) std::memcpy(at + sizeof position, color.data(), 3);
        used_ += sizeof position + (layout_.colors ? 3 : 0);
        ++vertices_;
    }
    std::string header() const;
    void flush();
    std::byte* room(std::size_t bytes) {
        if (used_ + bytes > buffer_.size()) flush();
        return buffer_.data() + used_;
    }

    std::string path_;
    OutputFile file_;
    VertexLayout layout_;
    std::string note_;
    std::vector<std::byte> buffer_;
    std::size_t used_ = 0;  // bytes of the buffer
    std::uint64_t vertices_ = 0, triangles_ = 0;
    std::optional<Error> error_;
    bool finished_ = false;
};

}  // namespace iwalk
