#pragma once

#include <glm/mat4x4.hpp>
#include <optional>
#include <vector>

#include "preprocess/import/importer.hpp"
#include "preprocess/import/triangle_output.hpp"
#include "preprocess/import/vrml_lexer.hpp"

namespace iwalk {

// One IndexedFaceSet as it stands in the file.
class VrmlMesh {
  public:
    explicit VrmlMesh(std::uint64_t memoryBytes) : memoryBytes_(memoryBytes) {}

    void clear();  // keeps the memory
    // The values of fields, behind their names. Fail when there is something else, or more than the memory
    // holds.
    Result<void> readPoints(VrmlLexer& lexer);
    Result<void> readColors(VrmlLexer& lexer);
    Result<void> readIndices(VrmlLexer& lexer) { return readIntegers(lexer, indices_); }
    Result<void> readColorIndices(VrmlLexer& lexer) { return readIntegers(lexer, colorIndices_); }

    VrmlLexer::Place place;      // of its beginning, for messages
    bool colorPerVertex = true;  // else per face
    bool counterClockwise = true;

    // Fails when an index is out of range.
    Result<void> check(const VrmlLexer& lexer) const;
    const std::vector<glm::dvec3>& points() const { return points_; }
    bool colored() const { return !colors_.empty(); }
    std::uint64_t triangleBound() const;
    // All polygons, moved by `matrix`; `color` (RGBA8) is for corners that have none of their own. Only
    // after check().
    Result<void> emit(const glm::dmat4& matrix, std::uint32_t color, TriangleOutput& output) const;

  private:
    template <class T>
    Result<void> reserve(const VrmlLexer& lexer, std::vector<T>& values);
    Result<void> readIntegers(VrmlLexer& lexer, std::vector<std::int32_t>& values);
    Result<void> readTriples(VrmlLexer& lexer, const std::function<Result<void>(const glm::dvec3&)>& use);
    std::size_t polygonEnd(std::size_t begin) const;
    std::uint32_t colorAt(std::size_t corner, std::size_t polygon) const;
    Result<void> emitPolygon(std::size_t begin, std::size_t end, std::size_t polygon, bool reversed,
                             const glm::dmat4& matrix, std::uint32_t color, TriangleOutput& output) const;

    std::uint64_t memoryBytes_;
    std::vector<glm::dvec3> points_;
    std::vector<std::int32_t> indices_, colorIndices_;  // a negative one ends a polygon
    std::vector<std::uint32_t> colors_;                 // RGBA8
};

// A colour of three numbers in [0, 1] as RGBA8; what lies outside is cut off.
std::uint32_t vrmlColor(const glm::dvec3& rgb);

}  // namespace iwalk
