#include "preprocess/build/dataset_importer.hpp"

#include <cmath>
#include <cstring>

#include "common/dataset/hierarchy.hpp"
#include "common/dataset/page.hpp"
#include "common/dataset/page_files.hpp"

namespace iwalk {
namespace {

class DatasetImporter : public Importer {
  public:
    DatasetImporter(Manifest manifest, Hierarchy hierarchy, PageFiles files)
        : manifest_(std::move(manifest)), hierarchy_(std::move(hierarchy)), files_(std::move(files)) {}

    // The manifest has it all; vertices are only needed to choose a lattice, which there is.
    Result<ImportSummary> scan(const VertexSink&, const ProgressSink&) override {
        ImportSummary summary;
        summary.vertices = manifest_.vertices;
        summary.triangleBound = manifest_.triangles;
        summary.bounds = manifest_.bounds;
        summary.precision = std::ldexp(1.0, manifest_.stepExponent);
        summary.colors = manifest_.colors;
        summary.normals = manifest_.normals;
        return summary;
    }

    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override {
        ImportCounts counts;
        std::vector<bool> done(hierarchy_.pages.size(), false);  // small nodes share pages
        for (const LevelRecord& entry : hierarchy_.entries) {
            if (entry.level != kFullLevel) continue;
            for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page) {
                if (done[page]) continue;
                done[page] = true;
                RETURN_IF_ERROR(addPage(page));
                counts.triangles += triangles_.size();
                RETURN_IF_ERROR(sink(triangles_));
                progress(static_cast<double>(counts.triangles) / static_cast<double>(manifest_.triangles));
            }
        }
        return counts;
    }

  private:
    Result<void> addPage(std::uint32_t number) {
        const PageRecord& record = hierarchy_.pages[number];
        const PageLayout layout = pageLayout(record);
        std::vector<std::byte> bytes(record.bytes), decoded(layout.bytes);
        RETURN_IF_ERROR(files_[record.file]->readAt(record.offset, bytes));
        const Result<PageTable> table = decodePage(bytes, record, decoded);
        if (!table) {
            return fail("{}: page {} at byte {}: {}", manifest_.pageFiles[record.file].name, number,
                        record.offset, table.error().message);
        }
        std::vector<Corner> corners(record.vertexCount);
        for (std::uint32_t v = 0; v < record.vertexCount; ++v) {
            const LatticePoint p = table->origin + LatticePoint(pageOffset(decoded, record, v));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                corners[v].position[axis] = std::ldexp(static_cast<double>(p[axis]), manifest_.stepExponent);
            }
            std::uint32_t normal = 0;
            if (manifest_.colors) std::memcpy(&corners[v].color, decoded.data() + layout.colors + 4 * v, 4);
            if (manifest_.normals) std::memcpy(&normal, decoded.data() + layout.normals + 4 * v, 4);
            if (manifest_.normals) corners[v].normal = unpackNormal(normal);
        }
        triangles_.resize(record.indexCount / 3);
        for (std::uint32_t i = 0; i < record.indexCount; ++i) {
            std::uint16_t index = 0;
            std::memcpy(&index, decoded.data() + layout.indices + 2 * i, 2);
            triangles_[i / 3][i % 3] = corners[index];
        }
        return {};
    }

    Manifest manifest_;
    Hierarchy hierarchy_;
    PageFiles files_;
    std::vector<Triangle> triangles_;  // of one page
};

}  // namespace

Result<std::unique_ptr<Importer>> openDatasetImporter(const std::string& dataset) {
    ASSIGN_OR_RETURN(Manifest manifest, loadManifest(dataset));
    ASSIGN_OR_RETURN(Hierarchy hierarchy, loadHierarchy(dataset, manifest));
    ASSIGN_OR_RETURN(PageFiles files, openPageFiles(dataset, manifest));
    return std::unique_ptr<Importer>(
        std::make_unique<DatasetImporter>(std::move(manifest), std::move(hierarchy), std::move(files)));
}

}  // namespace iwalk
