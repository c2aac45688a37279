#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "preprocess/import/importer.hpp"

namespace iwalk {

using ImporterFactory =
    std::function<Result<std::unique_ptr<Importer>>(const std::string&, const ImportLimits&)>;

// Some files that are read one after the other, twice: each is scanned, then each is streamed. They stay open
// in between while memory lasts; where there are too many for that, each is opened a second time, and scanned
// a second time if its importer needs that.
class ImporterList {
  public:
    // `limits.memoryBytes` is for all of them together.
    ImporterList(std::vector<std::string> paths, const ImportLimits& limits, ImporterFactory factory);

    std::size_t size() const { return paths_.size(); }
    // First pass, in any order.
    Result<ImportSummary> scan(std::size_t index, const VertexSink& vertices, const ProgressSink& progress);
    // Second pass, in any order.
    Result<ImportCounts> triangles(std::size_t index, const TriangleSink& sink, const ProgressSink& progress);

  private:
    std::vector<std::string> paths_;
    ImportLimits limits_;  // of one
    bool keep_;
    ImporterFactory factory_;
    std::vector<std::unique_ptr<Importer>> importers_;
};

// Progress of part `index` of `count` as progress of the whole.
ProgressSink partOf(const ProgressSink& whole, std::size_t index, std::size_t count);

}  // namespace iwalk
