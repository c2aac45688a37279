#include "preprocess/import/obj_blocks.hpp"

#include "preprocess/import/text.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {
namespace {

constexpr std::size_t kMostCorners = std::size_t{64} << 10;  // of a piece

std::optional<std::string> takeVertex(std::string_view rest, ObjVertexBlock& block) {
    // x y z, x y z w (the weight is for curves), or x y z r g b.
    ObjVertexBlock::Vertex& vertex = block.vertices.emplace_back();
    const std::size_t count = takeObjNumbers(rest, vertex.numbers.data(), vertex.numbers.size());
    vertex.colored = count == vertex.numbers.size();
    if (count >= 3) return {};
    block.vertices.pop_back();
    return fmt::format("a vertex needs three numbers, not {}", quote(trim(rest)));
}

std::optional<std::string> takeNormal(std::string_view rest, ObjVertexBlock& block) {
    glm::dvec3 written(0);
    if (takeObjNumbers(rest, &written.x, 3) < 3)
        return fmt::format("a normal needs three numbers, not {}", quote(trim(rest)));
    block.normals.push_back(unitOrZero(written));
    return {};
}

std::uint64_t trianglesOf(std::string_view rest) {
    std::uint64_t corners = 0;
    while (!takeWord(rest).empty()) ++corners;
    return corners > 2 ? corners - 2 : 0;
}

std::optional<std::string> takeLine(const ObjLine& line, ObjVertexBlock& block) {
    switch (line.keyword) {
        case ObjKeyword::vertex:
            return takeVertex(line.rest, block);
        case ObjKeyword::normal:
            return takeNormal(line.rest, block);
        case ObjKeyword::materialLibrary:
            block.libraries.emplace_back(line.rest);
            break;
        case ObjKeyword::face:
            block.triangleBound += trianglesOf(line.rest);
            break;
        default:
            break;
    }
    return {};
}

}  // namespace

void ObjVertexBlock::parse() {
    vertices.clear();
    normals.clear();
    libraries.clear();
    triangleBound = 0;
    Lines cursor(lines);
    for (std::string_view line; !lines.bad && cursor.next(line);) {
        if (auto what = takeLine(splitObjLine(line), *this)) lines.bad = {cursor.number(), std::move(*what)};
    }
    lineCount = cursor.linesRead();
}

void ObjFaceBlock::parse() {
    cursor_ = Lines(lines);
    inFace_ = ended_ = false;
    parseMore();
}

bool ObjFaceBlock::parseMore() {
    if (ended_) return false;
    faces.clear();
    corners.clear();
    materials.clear();
    badCorner.clear();
    vertices = normals = 0;
    if (inFace_) takeCorners(true);
    for (std::string_view line; !inFace_ && !ended_;) {
        if (cursor_.next(line)) {
            parseLine(line);
        } else {
            ended_ = true;
        }
    }
    return true;
}

void ObjFaceBlock::parseLine(std::string_view line) {
    const ObjLine split = splitObjLine(line);
    switch (split.keyword) {
        case ObjKeyword::vertex:
            ++vertices;
            break;
        case ObjKeyword::normal:
            ++normals;
            break;
        case ObjKeyword::useMaterial:
            materials.push_back({faces.size(), std::string(trim(split.rest))});
            break;
        case ObjKeyword::face:
            rest_ = split.rest;
            takeCorners(false);
            break;
        default:
            break;
    }
}

void ObjFaceBlock::takeCorners(bool goesOn) {
    const std::size_t before = corners.size();
    for (ObjCorner corner; corners.size() < kMostCorners && takeObjCorner(rest_, corner);)
        corners.push_back(corner);
    faces.push_back(
        {static_cast<std::uint32_t>(corners.size() - before), goesOn, vertices, normals, cursor_.number()});
    inFace_ = corners.size() == kMostCorners;
    if (inFace_ || rest_.empty()) return;
    badCorner = quote(takeWord(rest_));
    ended_ = true;
}

}  // namespace iwalk
