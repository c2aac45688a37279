#include "preprocess/build/inputs.hpp"

#include <algorithm>

namespace iwalk {

Inputs::Inputs(const std::vector<std::string>& paths, const Budget& budget, std::string spillDirectory,
               ImporterFactory factory)
    : paths_(paths), keep_(paths.size() <= budget.keptImporters), factory_(std::move(factory)) {
    limits_.memoryBytes = budget.importerBytes / (keep_ ? std::max<std::size_t>(paths.size(), 1) : 1);
    limits_.spillDirectory = std::move(spillDirectory);
    importers_.resize(paths.size());
}

Result<std::unique_ptr<Importer>> Inputs::open(std::size_t index) const {
    return factory_(paths_[index], limits_);
}

Result<std::vector<ImportSummary>> Inputs::scan(const VertexSink& vertices, const ProgressSink& progress) {
    std::vector<ImportSummary> summaries;
    const double inputs = static_cast<double>(paths_.size());
    for (std::size_t i = 0; i < paths_.size(); ++i) {
        ASSIGN_OR_RETURN(std::unique_ptr<Importer> importer, open(i));
        const auto part = [&](double done) { progress((static_cast<double>(i) + done) / inputs); };
        ASSIGN_OR_RETURN(const ImportSummary summary, importer->scan(vertices, part));
        summaries.push_back(summary);
        if (keep_) importers_[i] = std::move(importer);
    }
    return summaries;
}

Result<ImportCounts> Inputs::triangles(std::size_t index, const TriangleSink& sink,
                                       const ProgressSink& progress) {
    std::unique_ptr<Importer> importer = std::move(importers_[index]);
    if (!importer) {
        ASSIGN_OR_RETURN(importer, open(index));
        const auto ignored = [](std::span<const glm::dvec3>) {};
        RETURN_IF_ERROR(importer->scan(ignored, [](double) {}));
    }
    return importer->triangles(sink, progress);
}

}  // namespace iwalk
