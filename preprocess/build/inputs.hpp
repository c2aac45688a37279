#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "preprocess/build/budget.hpp"
#include "preprocess/build/build.hpp"
#include "preprocess/import/importer.hpp"

namespace iwalk {

using ImporterFactory =
    std::function<Result<std::unique_ptr<Importer>>(const std::string&, const ImportLimits&)>;

// All inputs of a build as one: each is scanned, then each is streamed. They stay open in between while
// memory lasts; where there are too many for that, each is opened and scanned a second time.
class Inputs {
  public:
    Inputs(const std::vector<std::string>& paths, const Budget& budget, std::string spillDirectory,
           ImporterFactory factory);

    // First pass. Positions of all vertices go to `vertices`.
    Result<std::vector<ImportSummary>> scan(const VertexSink& vertices, const ProgressSink& progress);
    // Second pass, input `index` alone; in the order of the inputs.
    Result<ImportCounts> triangles(std::size_t index, const TriangleSink& sink, const ProgressSink& progress);

  private:
    Result<std::unique_ptr<Importer>> open(std::size_t index) const;

    std::vector<std::string> paths_;
    ImportLimits limits_;
    bool keep_;
    ImporterFactory factory_;
    std::vector<std::unique_ptr<Importer>> importers_;
};

}  // namespace iwalk
