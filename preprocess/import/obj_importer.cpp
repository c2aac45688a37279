// An OBJ file may use a vertex before it defines it, and names of materials before their library: so the
// first pass keeps vertices, normals and materials, and the second one reads the faces.
#include "preprocess/import/obj_importer.hpp"

#include <algorithm>
#include <array>

#include "preprocess/import/memory_share.hpp"
#include "preprocess/import/mtl.hpp"
#include "preprocess/import/obj_blocks.hpp"
#include "preprocess/import/progress_meter.hpp"
#include "preprocess/import/read_ahead.hpp"
#include "preprocess/import/triangle_output.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {
namespace {

class ObjImporter : public Importer {
  public:
    ObjImporter(const std::string& path, std::unique_ptr<RandomAccessFile> file, const ImportLimits& limits)
        : path_(path),
          file_(std::move(file)),
          blocks_(blocksAtOnce(limits)),
          blockBytes_(limits.blockBytes),
          vertices_({.doubles = true, .colors = true}, storeBytes(limits, true) / 3 * 2,
                    limits.spillDirectory),
          normals_(sizeof(glm::vec3), storeBytes(limits, true) / 3, limits.spillDirectory) {}

    Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) override;
    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override;

  private:
    // What the second pass has come past.
    struct FacePass {
        std::uint64_t vertices = 0, normals = 0, faces = 0, lines = 0;
        std::uint32_t materialColor = Materials::kGrey;
    };

    // Reads the file block by block, and calls take(Block&) with each of them in order.
    template <class Block, class Take>
    Result<void> eachBlock(const ProgressSink& progress, const Take& take);
    Result<void> keepVertices(const ObjVertexBlock& block, const VertexSink& sink);
    Result<void> keepNormals(const ObjVertexBlock& block);
    Result<void> readFaces(const ObjFaceBlock& block, FacePass& pass, TriangleOutput& output);
    Result<Corner> cornerAt(const ObjCorner& written, const ObjFaceBlock::Face& face, const FacePass& pass);
    Error badFace(const ObjFaceBlock::Face& face, const FacePass& pass, std::string_view what) const;
    Result<void> readNormal(std::uint64_t index, glm::vec3& normal);
    bool colored() const { return vertexColors_ || materials_.anyColor(); }

    const std::string path_;
    const std::unique_ptr<RandomAccessFile> file_;
    const std::size_t blocks_, blockBytes_;  // at once; of each
    VertexStore vertices_;                   // alpha 0: without a colour of its own
    RecordStore normals_;                    // of unit length or 0
    Materials materials_;
    VertexBatch batch_;
    bool vertexColors_ = false;
};

template <class Block, class Take>
Result<void> ObjImporter::eachBlock(const ProgressSink& progress, const Take& take) {
    LineBlocks file(*file_, blockBytes_);
    ReadAhead<Block> reading(
        blocks_, [&](Block& block) { return file.next(block.lines); }, [](Block& block) { block.parse(); });
    ProgressMeter meter(progress, 0, file_->size());
    while (true) {
        ASSIGN_OR_RETURN(Block* const block, reading.next());
        if (!block) break;
        RETURN_IF_ERROR(take(*block));
        meter.at(block->lines.bytes.end());
    }
    meter.done();
    return {};
}

Result<ImportSummary> ObjImporter::scan(const VertexSink& vertices, const ProgressSink& progress) {
    ImportSummary summary;
    std::uint64_t lines = 0;
    const auto take = [&](const ObjVertexBlock& block) -> Result<void> {
        RETURN_IF_ERROR(keepVertices(block, vertices));
        RETURN_IF_ERROR(keepNormals(block));
        for (const std::string& library : block.libraries) materials_.load(path_, library);
        summary.triangleBound += block.triangleBound;
        if (block.lines.bad) return block.lines.bad->error(path_, lines);
        lines += block.lineCount;
        return {};
    };
    RETURN_IF_ERROR(eachBlock<ObjVertexBlock>(progress, take));
    if (vertices_.size() == 0) return fail("{}: has no vertices ('v' lines): not an OBJ model?", path_);

    summary.vertices = vertices_.finite();
    summary.bounds = vertices_.bounds();
    summary.precision = textPrecision(summary.bounds);
    summary.colors = colored();
    summary.normals = normals_.size() > 0;
    return summary;
}

Result<void> ObjImporter::keepVertices(const ObjVertexBlock& block, const VertexSink& sink) {
    for (std::size_t begin = 0; begin < block.vertices.size(); begin += VertexBatch::kRows) {
        batch_.rows = std::min(block.vertices.size() - begin, VertexBatch::kRows);
        for (std::size_t row = 0; row < batch_.rows; ++row) {
            const ObjVertexBlock::Vertex& vertex = block.vertices[begin + row];
            for (std::size_t i = 0; i < 3; ++i) {
                batch_.columns[kX + i][row] = vertex.numbers[i];
                batch_.columns[kRed + i][row] = vertex.numbers[3 + i] * 255;
            }
            batch_.columns[kAlpha][row] = vertex.colored ? 255 : 0;
            vertexColors_ |= vertex.colored;
        }
        RETURN_IF_ERROR(vertices_.add(batch_, sink));
    }
    return {};
}

Result<void> ObjImporter::keepNormals(const ObjVertexBlock& block) {
    for (const glm::vec3& normal : block.normals) {
        ASSIGN_OR_RETURN(std::byte* const record, normals_.append());
        std::memcpy(record, &normal, sizeof normal);
    }
    return {};
}

Result<ImportCounts> ObjImporter::triangles(const TriangleSink& sink, const ProgressSink& progress) {
    TriangleOutput output(normals_.size() > 0, sink);
    FacePass pass;
    const auto take = [&](ObjFaceBlock& block) -> Result<void> {
        RETURN_IF_ERROR(readFaces(block, pass, output));
        while (block.parseMore()) RETURN_IF_ERROR(readFaces(block, pass, output));
        pass.lines += block.lineCount();
        return {};
    };
    RETURN_IF_ERROR(eachBlock<ObjFaceBlock>(progress, take));
    RETURN_IF_ERROR(output.flush());
    return output.counts();
}

Result<void> ObjImporter::readFaces(const ObjFaceBlock& block, FacePass& pass, TriangleOutput& output) {
    auto material = block.materials.begin();
    const auto takeMaterials = [&](std::size_t face) {
        for (; material != block.materials.end() && material->face == face; ++material)
            pass.materialColor = materials_.color(material->name);
    };
    const ObjCorner* written = block.corners.data();
    for (std::size_t i = 0; i < block.faces.size(); ++i) {
        takeMaterials(i);
        const ObjFaceBlock::Face& face = block.faces[i];
        if (!face.goesOn) {
            output.begin();
            ++pass.faces;
        }
        for (const ObjCorner* const end = written + face.corners; written != end; ++written) {
            ASSIGN_OR_RETURN(const Corner corner, cornerAt(*written, face, pass));
            RETURN_IF_ERROR(output.corner(corner));
        }
    }
    takeMaterials(block.faces.size());
    if (block.lines.bad) return block.lines.bad->error(path_, pass.lines);
    if (!block.badCorner.empty()) {
        return badFace(block.faces.back(), pass,
                       fmt::format("{} is no corner: v, v/vt, v//vn or v/vt/vn is wanted", block.badCorner));
    }
    pass.vertices += block.vertices;
    pass.normals += block.normals;
    return {};
}

Result<Corner> ObjImporter::cornerAt(const ObjCorner& written, const ObjFaceBlock::Face& face,
                                     const FacePass& pass) {
    const std::uint64_t verticesBefore = pass.vertices + face.vertices;
    const std::uint64_t vertex = resolveObjIndex(written.vertex, verticesBefore, vertices_.size());
    if (vertex >= vertices_.size()) {
        return badFace(face, pass,
                       fmt::format("vertex index {}, but there are {} vertices, {} of them up to here",
                                   written.vertex, vertices_.size(), verticesBefore));
    }
    Corner corner;
    RETURN_IF_ERROR(vertices_.get(vertex, corner));
    const bool ownColor = corner.color != 0;
    if (!ownColor && colored()) corner.color = pass.materialColor;
    if (written.normal == 0) return corner;

    const std::uint64_t normalsBefore = pass.normals + face.normals;
    const std::uint64_t normal = resolveObjIndex(written.normal, normalsBefore, normals_.size());
    if (normal >= normals_.size()) {
        return badFace(face, pass,
                       fmt::format("normal index {}, but there are {} normals, {} of them up to here",
                                   written.normal, normals_.size(), normalsBefore));
    }
    RETURN_IF_ERROR(readNormal(normal, corner.normal));
    return corner;
}

Error ObjImporter::badFace(const ObjFaceBlock::Face& face, const FacePass& pass,
                           std::string_view what) const {
    return BadLine{face.line, fmt::format("face {}: {}", pass.faces, what)}.error(path_, pass.lines);
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
