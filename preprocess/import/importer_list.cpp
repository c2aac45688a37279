#include "preprocess/import/importer_list.hpp"

#include "preprocess/import/memory_share.hpp"

namespace iwalk {

ImporterList::ImporterList(std::vector<std::string> paths, const ImportLimits& limits,
                           ImporterFactory factory)
    : paths_(std::move(paths)),
      limits_(limits),
      keep_(paths_.size() <= limits.memoryBytes / kLeastImporterBytes),
      factory_(std::move(factory)),
      importers_(paths_.size()) {
    if (keep_) limits_.memoryBytes /= std::max<std::size_t>(paths_.size(), 1);
}

Result<ImportSummary> ImporterList::scan(std::size_t index, const VertexSink& vertices,
                                         const ProgressSink& progress) {
    ASSIGN_OR_RETURN(std::unique_ptr<Importer> importer, factory_(paths_[index], limits_));
    ASSIGN_OR_RETURN(const ImportSummary summary, importer->scan(vertices, progress));
    if (keep_) importers_[index] = std::move(importer);
    return summary;
}

Result<ImportCounts> ImporterList::triangles(std::size_t index, const TriangleSink& sink,
                                             const ProgressSink& progress) {
    std::unique_ptr<Importer> importer = std::move(importers_[index]);
    if (!importer) {
        ASSIGN_OR_RETURN(importer, factory_(paths_[index], limits_));
        if (importer->needsScan())
            RETURN_IF_ERROR(importer->scan([](std::span<const glm::dvec3>) {}, [](double) {}));
    }
    return importer->triangles(sink, progress);
}

ProgressSink partOf(const ProgressSink& whole, std::size_t index, std::size_t count) {
    return [&whole, index, count](double done) {
        if (whole) whole((static_cast<double>(index) + done) / static_cast<double>(count));
    };
}

}  // namespace iwalk
