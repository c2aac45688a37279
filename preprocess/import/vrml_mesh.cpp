// ISO/IEC 14772-1:1997, 6.23 IndexedFaceSet. Polygons are fanned; normals and textures are not used.
#include "preprocess/import/vrml_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/matrix.hpp>

#include "common/settings.hpp"

namespace iwalk {

std::uint32_t vrmlColor(const glm::dvec3& rgb) {
    std::array<std::uint8_t, 4> bytes{0, 0, 0, 255};
    for (std::size_t i = 0; i < 3; ++i) {
        bytes[i] = rgb[i] > 0 ? static_cast<std::uint8_t>(std::lround(std::min(rgb[i], 1.0) * 255))
                              : std::uint8_t{0};
    }
    std::uint32_t color = 0;
    std::memcpy(&color, bytes.data(), sizeof color);
    return color;
}

void VrmlMesh::clear() {
    points_.clear(), indices_.clear(), colorIndices_.clear(), colors_.clear();
    colorPerVertex = counterClockwise = true;
}

// Makes room for one more. Vectors of one set may take all the memory, also while one of them moves.
template <class T>
Result<void> VrmlMesh::reserve(const VrmlLexer& lexer, std::vector<T>& values) {
    if (values.size() < values.capacity()) return {};
    const std::size_t wanted = std::max<std::size_t>(1024, 2 * values.capacity());
    const std::uint64_t held = points_.capacity() * sizeof(glm::dvec3) +
                               (indices_.capacity() + colorIndices_.capacity() + colors_.capacity()) * 4;
    if (held + wanted * sizeof(T) > memoryBytes_) {
        return lexer.bad(
            fmt::format("an IndexedFaceSet takes more than the {} there are for it: give more "
                        "--memory",
                        formatBytes(memoryBytes_)));
    }
    values.reserve(wanted);
    return {};
}

Result<void> VrmlMesh::readTriples(VrmlLexer& lexer,
                                   const std::function<Result<void>(const glm::dvec3&)>& use) {
    ASSIGN_OR_RETURN(const VrmlLexer::Token token, lexer.next());
    if (token.kind != VrmlLexer::Kind::openBracket) return lexer.bad("a list in brackets is wanted here");
    for (;;) {
        glm::dvec3 triple(0);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            ASSIGN_OR_RETURN(const bool more, lexer.number(triple[axis]));
            if (more) continue;
            ASSIGN_OR_RETURN(const bool closed, lexer.closeBracket());
            if (closed && axis == 0) return {};
            return lexer.bad(closed ? "the number of numbers is no multiple of three"
                                    : "a number is wanted here");
        }
        RETURN_IF_ERROR(use(triple));
    }
}

Result<void> VrmlMesh::readPoints(VrmlLexer& lexer) {
    points_.clear();
    return readTriples(lexer, [&](const glm::dvec3& point) -> Result<void> {
        RETURN_IF_ERROR(reserve(lexer, points_));
        points_.push_back(point);
        return {};
    });
}

Result<void> VrmlMesh::readColors(VrmlLexer& lexer) {
    colors_.clear();
    return readTriples(lexer, [&](const glm::dvec3& color) -> Result<void> {
        RETURN_IF_ERROR(reserve(lexer, colors_));
        colors_.push_back(vrmlColor(color));
        return {};
    });
}

Result<void> VrmlMesh::readIntegers(VrmlLexer& lexer, std::vector<std::int32_t>& values) {
    values.clear();
    ASSIGN_OR_RETURN(const VrmlLexer::Token token, lexer.next());
    if (token.kind != VrmlLexer::Kind::openBracket) return lexer.bad("a list in brackets is wanted here");
    for (;;) {
        RETURN_IF_ERROR(reserve(lexer, values));
        std::int32_t value = 0;
        ASSIGN_OR_RETURN(const bool more, lexer.integer(value));
        if (more) {
            values.push_back(value);
            continue;
        }
        ASSIGN_OR_RETURN(const bool closed, lexer.closeBracket());
        return closed ? Result<void>() : Result<void>(lexer.bad("a whole number is wanted here"));
    }
}

std::size_t VrmlMesh::polygonEnd(std::size_t begin) const {
    while (begin < indices_.size() && indices_[begin] >= 0) ++begin;
    return begin;
}

// Of a corner, numbered as in coordIndex, of a polygon. Only where the set is coloured.
std::uint32_t VrmlMesh::colorAt(std::size_t corner, std::size_t polygon) const {
    if (colorPerVertex)
        return colors_[static_cast<std::size_t>((colorIndices_.empty() ? indices_ : colorIndices_)[corner])];
    return colors_[colorIndices_.empty() ? polygon : static_cast<std::size_t>(colorIndices_[polygon])];
}

Result<void> VrmlMesh::check(const VrmlLexer& lexer) const {
    const auto bad = [&](std::string_view what) { return lexer.badAt(place, what); };
    std::size_t polygons = 0;
    for (std::size_t at = 0; at < indices_.size(); ++at) {
        if (indices_[at] >= 0 && static_cast<std::size_t>(indices_[at]) >= points_.size()) {
            return bad(fmt::format("coordIndex {} of this IndexedFaceSet, but it has {} points", indices_[at],
                                   points_.size()));
        }
        const bool last = at + 1 == indices_.size() || indices_[at + 1] < 0;
        polygons += last && indices_[at] >= 0;
        if (colors_.empty() || !colorPerVertex || indices_[at] < 0) continue;
        const std::vector<std::int32_t>& from = colorIndices_.empty() ? indices_ : colorIndices_;
        if (at >= from.size() || from[at] < 0 || static_cast<std::size_t>(from[at]) >= colors_.size())
            return bad("a corner of this IndexedFaceSet has no colour");
    }
    if (colors_.empty() || colorPerVertex) return {};
    for (std::size_t polygon = 0; polygon < polygons; ++polygon) {
        const bool listed = !colorIndices_.empty();
        if (listed && (polygon >= colorIndices_.size() || colorIndices_[polygon] < 0))
            return bad("a face of this IndexedFaceSet has no colour");
        const std::size_t color = listed ? static_cast<std::size_t>(colorIndices_[polygon]) : polygon;
        if (color >= colors_.size()) return bad("a face of this IndexedFaceSet has no colour");
    }
    return {};
}

std::uint64_t VrmlMesh::triangleBound() const {
    std::uint64_t triangles = 0;
    for (std::size_t begin = 0; begin < indices_.size();) {
        const std::size_t end = polygonEnd(begin);
        if (end - begin > 2) triangles += end - begin - 2;
        begin = end + 1;
    }
    return triangles;
}

Result<void> VrmlMesh::emit(const glm::dmat4& matrix, std::uint32_t color, TriangleOutput& output) const {
    const bool mirrored = glm::determinant(glm::dmat3(matrix)) < 0;
    const bool reversed = mirrored == counterClockwise;
    std::size_t polygon = 0;
    for (std::size_t begin = 0; begin < indices_.size();) {
        const std::size_t end = polygonEnd(begin);
        if (end > begin) RETURN_IF_ERROR(emitPolygon(begin, end, polygon++, reversed, matrix, color, output));
        begin = end + 1;
    }
    return {};
}

Result<void> VrmlMesh::emitPolygon(std::size_t begin, std::size_t end, std::size_t polygon, bool reversed,
                                   const glm::dmat4& matrix, std::uint32_t color,
                                   TriangleOutput& output) const {
    output.begin();
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t at = reversed ? end - 1 - (i - begin) : i;
        Corner corner;
        corner.position = glm::dvec3(matrix * glm::dvec4(points_[static_cast<std::size_t>(indices_[at])], 1));
        corner.color = colors_.empty() ? color : colorAt(at, polygon);
        RETURN_IF_ERROR(output.corner(corner));
    }
    return {};
}

}  // namespace iwalk
