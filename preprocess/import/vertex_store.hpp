#pragma once

#include <array>
#include <cstring>
#include <string>

#include "preprocess/import/importer.hpp"
#include "preprocess/import/record_store.hpp"

namespace iwalk {

// What a vertex record holds: a position of 3 floats (12 bytes) or 3 doubles (24), then RGBA8 and 3 floats of
// normal where the input has them.
struct VertexFormat {
    bool doubles = false, colors = false, normals = false;

    std::size_t colorOffset() const { return doubles ? 24 : 12; }
    std::size_t normalOffset() const { return colorOffset() + (colors ? 4 : 0); }
    std::size_t bytes() const { return normalOffset() + (normals ? 12 : 0); }
};

// Columns of a vertex batch: position, normal (any length), colour (each 0..255, clamped and rounded when
// kept).
enum VertexColumn : int {
    kX,
    kY,
    kZ,
    kNormalX,
    kNormalY,
    kNormalZ,
    kRed,
    kGreen,
    kBlue,
    kAlpha,
    kColumns,
    kNoColumn = -1
};

// Some vertices as the readers fill them in, column by column.
struct VertexBatch {
    static constexpr std::size_t kRows = 1024;
    std::size_t rows = 0;
    std::array<std::array<double, kRows>, kColumns> columns;

    VertexBatch() { columns[kAlpha].fill(255); }
};

// v at unit length, or 0 where it has none (zero or not finite).
glm::vec3 unitOrZero(const glm::dvec3& v);

// All vertices of an input, kept for its faces.
class VertexStore {
  public:
    VertexStore(VertexFormat format, std::uint64_t memoryBytes, const std::string& spillDirectory);

    // Keeps the batch's rows, and hands the finite positions on.
    Result<void> add(const VertexBatch& batch, const VertexSink& sink);

    // Vertex `index` < size(). Where it has no usable normal, that is 0.
    Result<void> get(std::uint64_t index, Corner& out) {
        const std::byte* record = records_.find(index);
        if (!record) {
            ASSIGN_OR_RETURN(record, records_.load(index));
        }
        decode(record, out);
        return {};
    }

    const VertexFormat& format() const { return format_; }
    std::uint64_t size() const { return records_.size(); }
    std::uint64_t finite() const { return finite_; }    // vertices with finite positions
    const ModelBox& bounds() const { return bounds_; }  // of those

  private:
    void decode(const std::byte* record, Corner& out) const;
    void encode(const VertexBatch& batch, std::size_t row, std::byte* record) const;

    VertexFormat format_;
    RecordStore records_;
    std::uint64_t finite_ = 0;
    ModelBox bounds_;
    std::vector<glm::dvec3> positions_;  // of the batch under way
};

inline void VertexStore::decode(const std::byte* record, Corner& out) const {
    if (format_.doubles) {
        std::memcpy(&out.position, record, sizeof out.position);
    } else {
        glm::vec3 position;
        std::memcpy(&position, record, sizeof position);
        out.position = glm::dvec3(position);
    }
    if (format_.colors) std::memcpy(&out.color, record + format_.colorOffset(), sizeof out.color);
    if (format_.normals) std::memcpy(&out.normal, record + format_.normalOffset(), sizeof out.normal);
}

double largestCoordinate(const ModelBox& bounds);  // the largest |coordinate|; 0 of an empty box

// The spacing of numbers with `bits` of fraction (23: float, 52: double) at the box's largest |coordinate|;
// where all are 0, at 1.
double coordinateSpacing(const ModelBox& bounds, int bits);

// The same for decimal text, which does not say how precise it is. Most files hold printed floats;
// coordinates far from 0 against the model's size (map coordinates) only make sense as doubles.
double textPrecision(const ModelBox& bounds);

}  // namespace iwalk
