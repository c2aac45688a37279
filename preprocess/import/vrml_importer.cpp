#include "preprocess/import/vrml_importer.hpp"

#include <spdlog/spdlog.h>

#include "preprocess/import/memory_share.hpp"
#include "preprocess/import/progress_meter.hpp"
#include "preprocess/import/vertex_output.hpp"
#include "preprocess/import/vertex_store.hpp"
#include "preprocess/import/vrml_scene.hpp"

namespace iwalk {
namespace {

class VrmlImporter : public Importer {
  public:
    VrmlImporter(std::string path, std::unique_ptr<RandomAccessFile> file, const ImportLimits& limits)
        : path_(std::move(path)), file_(std::move(file)), memoryBytes_(storeBytes(limits, false)) {}

    Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) override {
        VertexOutput output(vertices);
        ImportSummary summary;
        RETURN_IF_ERROR(walk(progress, true, [&](const VrmlMesh& mesh, const glm::dmat4& matrix, auto color) {
            for (const glm::dvec3& point : mesh.points())
                output.add(glm::dvec3(matrix * glm::dvec4(point, 1)));
            summary.triangleBound += mesh.triangleBound();
            summary.colors = summary.colors || color || mesh.colored();
            return Result<void>();
        }));
        output.finish(summary);
        summary.precision = textPrecision(summary.bounds);
        return summary;
    }

    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override {
        TriangleOutput output(false, sink);
        RETURN_IF_ERROR(
            walk(progress, false, [&](const VrmlMesh& mesh, const glm::dmat4& matrix, auto color) {
                return mesh.emit(matrix, color.value_or(kPlainColor), output);
            }));
        RETURN_IF_ERROR(output.flush());
        return output.counts();
    }
    bool needsScan() const override { return false; }

  private:
    Result<void> walk(const ProgressSink& progress, bool first, const VrmlScene::Visit& visit) {
        ProgressMeter meter(progress, 0, file_->size());
        const VrmlScene* walked = nullptr;
        const VrmlScene::Visit metered = [&](const VrmlMesh& mesh, const glm::dmat4& matrix, auto color) {
            meter.at(walked->furthest());
            return visit(mesh, matrix, color);
        };
        VrmlScene scene(*file_, path_, memoryBytes_, metered);
        walked = &scene;
        RETURN_IF_ERROR(scene.walk());
        for (const auto& [type, count] : scene.leftOut()) {
            if (first) spdlog::warn("{}: {} {} left out: only IndexedFaceSets are read", path_, count, type);
        }
        meter.done();
        return {};
    }

    const std::string path_;
    const std::unique_ptr<RandomAccessFile> file_;
    const std::uint64_t memoryBytes_;
};

}  // namespace

Result<std::unique_ptr<Importer>> openVrml(const std::string& path, std::unique_ptr<RandomAccessFile> file,
                                           const ImportLimits& limits) {
    std::array<char, 10> head{};
    const auto loaded = static_cast<std::size_t>(std::min<std::uint64_t>(head.size(), file->size()));
    RETURN_IF_ERROR(file->readAt(0, std::as_writable_bytes(std::span(head.data(), loaded))));
    const std::string_view magic(head.data(), loaded);
    if (magic.starts_with("\x1f\x8b")) return fail("{}: is compressed: unpack it with gzip -d first", path);
    if (magic.starts_with("#VRML V1.0")) return fail("{}: is VRML 1.0: only VRML97 (2.0) can be read", path);
    if (!magic.starts_with("#VRML V2.0"))
        return fail("{}: does not begin with '#VRML V2.0': not a VRML97 model?", path);
    return std::unique_ptr<Importer>(std::make_unique<VrmlImporter>(path, std::move(file), limits));
}

}  // namespace iwalk
