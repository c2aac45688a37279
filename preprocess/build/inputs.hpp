#pragma once

#include <string>
#include <vector>

#include "preprocess/build/budget.hpp"
#include "preprocess/build/build.hpp"
#include "preprocess/import/importer_list.hpp"

namespace iwalk {

// The files that are meant by what stands on the command line, in order: names of files as they are,
// directories with all models below them, and patterns (*, ?, [...]) with all files that match. Fails where
// there is none.
Result<std::vector<std::string>> findInputs(const std::vector<std::string>& names);

// All inputs of a build as one: each is scanned, then each is streamed; turned so that z is up. To be used by
// the one that leads the reading threads.
class Inputs {
  public:
    Inputs(const BuildOptions& options, const Budget& budget, const std::string& spillDirectory,
           ImporterFactory factory);

    // First pass. Positions of all vertices go to `vertices`. Precisions are those of nearly all vertices of
    // an input: a stray far out does not make the others coarse.
    Result<std::vector<ImportSummary>> scan(const VertexSink& vertices, const ProgressSink& progress);
    // Second pass, input `index` alone; in the order of the inputs.
    Result<ImportCounts> triangles(std::size_t index, const TriangleSink& sink, const ProgressSink& progress);

  private:
    bool turn_;
    ImporterList files_;
};

}  // namespace iwalk
