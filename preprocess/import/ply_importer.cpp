#include "preprocess/import/ply_importer.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "preprocess/import/memory_share.hpp"
#include "preprocess/import/ply_faces.hpp"
#include "preprocess/import/ply_vertices.hpp"
#include "preprocess/import/text.hpp"

namespace iwalk {
namespace {

class PlyImporter : public Importer {
  public:
    PlyImporter(const std::string& path, std::unique_ptr<RandomAccessFile> file, PlyHeader header,
                PlyVertexPlan plan, const ImportLimits& limits)
        : path_(path),
          file_(std::move(file)),
          header_(std::move(header)),
          plan_(std::move(plan)),
          store_(plan_.format, storeBytes(limits, header_.format == PlyFormat::ascii), limits.spillDirectory),
          values_(makePlyValues(header_.format, *file_, header_.bytes, path_, limits)) {}

    Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) override;
    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override;

  private:
    Result<void> skipTo(std::string_view element);
    Result<void> skipElement(const PlyElement& element);
    std::uint64_t triangleBound() const;
    void warnAboutEnd() const;

    const std::string path_;
    const std::unique_ptr<RandomAccessFile> file_;
    const PlyHeader header_;
    const PlyVertexPlan plan_;
    VertexStore store_;
    const std::unique_ptr<PlyValues> values_;
    std::size_t element_ = 0;  // the one that values_ stands at the beginning of
};

Result<void> PlyImporter::skipElement(const PlyElement& element) {
    if (element.properties.empty()) return {};
    if (header_.format != PlyFormat::ascii && !element.hasLists()) {
        // Checked to lie within the file, with checkPlyCounts().
        values_->seek(values_->offset() + element.count * element.leastBytes(header_.format));
        return {};
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
        values_->record(element, i);
        for (const PlyProperty& property : element.properties) RETURN_IF_ERROR(values_->skip(property));
    }
    return {};
}

// From the beginning of the data when the element lies before the place reached: faces may come before
// vertices.
Result<void> PlyImporter::skipTo(std::string_view name) {
    const PlyElement* const wanted = header_.find(name);
    const auto index = static_cast<std::size_t>(wanted - header_.elements.data());
    if (index < element_) {
        values_->seek(header_.bytes);
        element_ = 0;
    }
    for (; element_ < index; ++element_) RETURN_IF_ERROR(skipElement(header_.elements[element_]));
    return {};
}

Result<ImportSummary> PlyImporter::scan(const VertexSink& vertices, const ProgressSink& progress) {
    RETURN_IF_ERROR(skipTo("vertex"));
    const PlyElement& element = header_.elements[element_];
    const bool fixed = header_.format != PlyFormat::ascii && !element.hasLists();
    const std::uint64_t end = values_->offset() + element.count * element.leastBytes(header_.format);
    ProgressMeter meter(progress, values_->offset(), fixed ? end : file_->size());
    RETURN_IF_ERROR(readPlyVertices(element, header_.format, plan_, *values_, store_, vertices, meter));
    ++element_;
    values_->pause();
    meter.done();

    ImportSummary summary;
    summary.vertices = store_.finite();
    summary.triangleBound = triangleBound();
    summary.bounds = store_.bounds();
    summary.precision =
        plan_.precisionBits > 0 ? coordinateSpacing(store_.bounds(), plan_.precisionBits) : 1.0;
    summary.colors = plan_.format.colors;
    summary.normals = plan_.format.normals;
    return summary;
}

// As many as the bytes behind the vertices can hold indices, were they one polygon. In a text that says
// nothing.
std::uint64_t PlyImporter::triangleBound() const {
    const PlyElement* const face = header_.find("face");
    if (!face || face->count == 0 || header_.format == PlyFormat::ascii) return 0;
    const bool before = face < header_.elements.data() + element_;
    const std::uint64_t bytes = before ? file_->size() - header_.bytes : values_->rest();
    std::size_t indexBytes = 1;
    for (const PlyProperty& p : face->properties) {
        if (isPlyIndices(p)) indexBytes = plyTypeBytes(p.type);
    }
    return (bytes - std::min(bytes, face->count * face->leastBytes(header_.format))) / indexBytes;
}

Result<ImportCounts> PlyImporter::triangles(const TriangleSink& sink, const ProgressSink& progress) {
    const PlyElement* const face = header_.find("face");
    if (!face || face->count == 0) return ImportCounts{};
    RETURN_IF_ERROR(skipTo("face"));
    TriangleOutput output(plan_.format.normals, sink);
    ProgressMeter meter(progress, values_->offset(), file_->size());
    RETURN_IF_ERROR(
        readPlyFaces(header_.elements[element_], header_.format, *values_, path_, store_, output, meter));
    RETURN_IF_ERROR(output.flush());
    ++element_;
    warnAboutEnd();
    values_->pause();
    meter.done();
    return output.counts();
}

// A text cut inside its last number looks like a whole one.
void PlyImporter::warnAboutEnd() const {
    if (header_.format == PlyFormat::ascii && values_->rest() == 0 && element_ == header_.elements.size()) {
        spdlog::warn("{}: the last line has no end: the file may be cut short", path_);
    }
}

Result<void> checkElements(const PlyHeader& header, const std::string& path) {
    if (!header.find("vertex")) return fail("{}: header has no element vertex: no positions to read", path);
    if (const PlyElement* const strips = header.find("tristrips"); strips && strips->count > 0) {
        return fail("{}: triangle strips (element tristrips) are not supported: save the model with faces",
                    path);
    }
    if (const PlyElement* const face = header.find("face"); face && face->count > 0) {
        if (auto found = findPlyIndices(*face, path); !found) return found.error();
    }
    return {};
}

}  // namespace

Result<std::unique_ptr<Importer>> openPly(const std::string& path, std::unique_ptr<RandomAccessFile> file,
                                          const ImportLimits& limits) {
    ByteStream stream(*file);
    RETURN_IF_ERROR(stream.fill(kMaxPlyHeaderBytes));
    ASSIGN_OR_RETURN(PlyHeader header, parsePlyHeader(stream.view(), path));
    RETURN_IF_ERROR(checkElements(header, path));
    RETURN_IF_ERROR(checkPlyCounts(header, file->size(), path));
    ASSIGN_OR_RETURN(PlyVertexPlan plan, planPlyVertices(*header.find("vertex"), path));
    return std::unique_ptr<Importer>(
        std::make_unique<PlyImporter>(path, std::move(file), std::move(header), std::move(plan), limits));
}

}  // namespace iwalk
