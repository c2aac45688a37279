// An OBJ file may use a vertex before it defines it, and names of materials before their library: so the
// first pass keeps vertices, normals and materials, and the second one reads the faces.
#include "preprocess/import/obj_importer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "preprocess/import/line_reader.hpp"
#include "preprocess/import/memory_share.hpp"
#include "preprocess/import/mtl.hpp"
#include "preprocess/import/obj_line.hpp"
#include "preprocess/import/progress_meter.hpp"
#include "preprocess/import/text.hpp"
#include "preprocess/import/triangle_output.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {
namespace {

class ObjImporter : public Importer {
  public:
    ObjImporter(const std::string& path, std::unique_ptr<RandomAccessFile> file, const ImportLimits& limits)
        : path_(path),
          file_(std::move(file)),
          vertices_({.doubles = true, .colors = true}, storeBytes(limits.memoryBytes) / 3 * 2,
                    limits.spillDirectory),
          normals_(sizeof(glm::vec3), storeBytes(limits.memoryBytes) / 3, limits.spillDirectory) {}

    Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) override;
    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override;

  private:
    // What the second pass has come past.
    struct FacePass {
        std::uint64_t vertices = 0, normals = 0, faces = 0;
        std::uint32_t materialColor = Materials::kGrey;
    };

    Result<void> scanLine(const ObjLine& line, const LineReader& lines);
    Result<void> scanVertex(std::string_view rest, const LineReader& lines);
    Result<void> scanNormal(std::string_view rest, const LineReader& lines);
    Result<void> keepBatch(const VertexSink& sink);
    Result<void> readLine(const ObjLine& line, const LineReader& lines, FacePass& pass,
                          TriangleOutput& output);
    Result<void> readFace(std::string_view rest, const LineReader& lines, const FacePass& pass,
                          TriangleOutput& output);
    Result<Corner> cornerAt(const ObjCorner& written, const LineReader& lines, const FacePass& pass);
    Result<void> readNormal(std::uint64_t index, glm::vec3& normal);
    bool colored() const { return vertexColors_ || materials_.anyColor(); }

    const std::string path_;
    const std::unique_ptr<RandomAccessFile> file_;
    VertexStore vertices_;  // alpha 0: without a colour of its own
    RecordStore normals_;   // of unit length or 0
    Materials materials_;
    VertexBatch batch_;
    bool vertexColors_ = false;
    std::uint64_t triangleBound_ = 0;
};

Result<ImportSummary> ObjImporter::scan(const VertexSink& vertices, const ProgressSink& progress) {
    LineReader lines(*file_, path_);
    ProgressMeter meter(progress, 0, file_->size());
    for (std::string_view line;;) {
        ASSIGN_OR_RETURN(const bool more, lines.next(line));
        if (!more) break;
        RETURN_IF_ERROR(scanLine(splitObjLine(line), lines));
        if (batch_.rows == VertexBatch::kRows) RETURN_IF_ERROR(keepBatch(vertices));
        meter.at(lines.offset());
    }
    RETURN_IF_ERROR(keepBatch(vertices));
    if (vertices_.size() == 0) return fail("{}: has no vertices ('v' lines): not an OBJ model?", path_);
    meter.done();

    ImportSummary summary;
    summary.vertices = vertices_.finite();
    summary.triangleBound = triangleBound_;
    summary.bounds = vertices_.bounds();
    summary.precision = textPrecision(summary.bounds);
    summary.colors = colored();
    summary.normals = normals_.size() > 0;
    return summary;
}

Result<void> ObjImporter::scanLine(const ObjLine& line, const LineReader& lines) {
    switch (line.keyword) {
        case ObjKeyword::vertex:
            return scanVertex(line.rest, lines);
        case ObjKeyword::normal:
            return scanNormal(line.rest, lines);
        case ObjKeyword::materialLibrary:
            materials_.load(path_, line.rest);
            break;
        case ObjKeyword::face: {
            std::string_view rest = line.rest;
            std::uint64_t corners = 0;
            while (!takeWord(rest).empty()) ++corners;
            triangleBound_ += corners > 2 ? corners - 2 : 0;
            break;
        }
        default:
            break;
    }
    return {};
}

// x y z, x y z w (the weight is for curves), or x y z r g b.
Result<void> ObjImporter::scanVertex(std::string_view rest, const LineReader& lines) {
    std::array<double, 6> values{};
    const std::size_t count = takeObjNumbers(rest, values.data(), values.size());
    if (count < 3) return lines.bad(fmt::format("a vertex needs three numbers, not {}", quote(trim(rest))));
    const std::size_t row = batch_.rows++;
    for (std::size_t i = 0; i < 3; ++i) {
        batch_.columns[kX + i][row] = values[i];
        batch_.columns[kRed + i][row] = values[3 + i] * 255;
    }
    batch_.columns[kAlpha][row] = count == 6 ? 255 : 0;
    vertexColors_ |= count == 6;
    return {};
}

Result<void> ObjImporter::scanNormal(std::string_view rest, const LineReader& lines) {
    glm::dvec3 written(0);
    if (takeObjNumbers(rest, &written.x, 3) < 3) {
        return lines.bad(fmt::format("a normal needs three numbers, not {}", quote(trim(rest))));
    }
    const glm::vec3 normal = unitOrZero(written);
    ASSIGN_OR_RETURN(std::byte* const record, normals_.append());
    std::memcpy(record, &normal, sizeof normal);
    return {};
}

Result<void> ObjImporter::keepBatch(const VertexSink& sink) {
    RETURN_IF_ERROR(vertices_.add(batch_, sink));
    batch_.rows = 0;
    return {};
}

Result<ImportCounts> ObjImporter::triangles(const TriangleSink& sink, const ProgressSink& progress) {
    LineReader lines(*file_, path_);
    ProgressMeter meter(progress, 0, file_->size());
    TriangleOutput output(normals_.size() > 0, sink);
    FacePass pass;
    for (std::string_view line;;) {
        ASSIGN_OR_RETURN(const bool more, lines.next(line));
        if (!more) break;
        RETURN_IF_ERROR(readLine(splitObjLine(line), lines, pass, output));
        meter.at(lines.offset());
    }
    RETURN_IF_ERROR(output.flush());
    meter.done();
    return output.counts();
}

Result<void> ObjImporter::readLine(const ObjLine& line, const LineReader& lines, FacePass& pass,
                                   TriangleOutput& output) {
    switch (line.keyword) {
        case ObjKeyword::vertex:
            ++pass.vertices;
            break;
        case ObjKeyword::normal:
            ++pass.normals;
            break;
        case ObjKeyword::useMaterial:
            pass.materialColor = materials_.color(trim(line.rest));
            break;
        case ObjKeyword::face:
            ++pass.faces;
            return readFace(line.rest, lines, pass, output);
        default:
            break;
    }
    return {};
}

Result<void> ObjImporter::readFace(std::string_view rest, const LineReader& lines, const FacePass& pass,
                                   TriangleOutput& output) {
    output.begin();
    for (ObjCorner written; takeObjCorner(rest, written);) {
        ASSIGN_OR_RETURN(const Corner corner, cornerAt(written, lines, pass));
        RETURN_IF_ERROR(output.corner(corner));
    }
    if (rest.empty()) return {};
    return lines.bad(fmt::format("face {}: {} is no corner: v, v/vt, v//vn or v/vt/vn is wanted", pass.faces,
                                 quote(takeWord(rest))));
}

Result<Corner> ObjImporter::cornerAt(const ObjCorner& written, const LineReader& lines,
                                     const FacePass& pass) {
    const std::uint64_t vertex = resolveObjIndex(written.vertex, pass.vertices, vertices_.size());
    if (vertex >= vertices_.size()) {
        return lines.bad(
            fmt::format("face {}: vertex index {}, but there are {} vertices, {} of them up to here",
                        pass.faces, written.vertex, vertices_.size(), pass.vertices));
    }
    Corner corner;
    RETURN_IF_ERROR(vertices_.get(vertex, corner));
    const bool ownColor = corner.color != 0;
    if (!ownColor && colored()) corner.color = pass.materialColor;
    if (written.normal == 0) return corner;

    const std::uint64_t normal = resolveObjIndex(written.normal, pass.normals, normals_.size());
    if (normal >= normals_.size()) {
        return lines.bad(
            fmt::format("face {}: normal index {}, but there are {} normals, {} of them up to here",
                        pass.faces, written.normal, normals_.size(), pass.normals));
    }
    RETURN_IF_ERROR(readNormal(normal, corner.normal));
    return corner;
}

Result<void> ObjImporter::readNormal(std::uint64_t index, glm::vec3& normal) {
    const std::byte* record = normals_.find(index);
    if (!record) {
        ASSIGN_OR_RETURN(record, normals_.load(index));
    }
    std::memcpy(&normal, record, sizeof normal);
    return {};
}

}  // namespace

Result<std::unique_ptr<Importer>> openObj(const std::string& path, std::unique_ptr<RandomAccessFile> file,
                                          const ImportLimits& limits) {
    std::array<unsigned char, 2> mark{};
    if (file->size() >= 2) RETURN_IF_ERROR(file->readAt(0, std::as_writable_bytes(std::span(mark))));
    if ((mark[0] == 0xff && mark[1] == 0xfe) || (mark[0] == 0xfe && mark[1] == 0xff)) {
        return fail("{}: is UTF-16 text (byte 0): save it as UTF-8", path);
    }
    return std::unique_ptr<Importer>(std::make_unique<ObjImporter>(path, std::move(file), limits));
}

}  // namespace iwalk
