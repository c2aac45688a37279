#pragma once

#include <string>

#include "preprocess/build/build.hpp"
#include "preprocess/build/page_writer.hpp"
#include "preprocess/build/spill.hpp"
#include "preprocess/levels/model.hpp"
#include "preprocess/levels/page_store.hpp"

namespace iwalk {

// How much is in memory at once. Datasets depend on it, so only tests choose other sizes.
struct LevelSizes {
    // Triangles that entries are made of, with at most twice as many vertices. An entry made of more goes
    // through a temporary file.
    std::uint64_t chunkTriangles = 200'000;
    // Triangles, and points, of a cell that is decided at once; a larger one is decided in halves.
    std::size_t cellTriangles = 131'072;
};

struct LevelOptions {
    std::uint32_t leafTriangles = 0;
    unsigned threads = 1;
    LevelSizes sizes{};
};

// Completes a model whose full resolution is in pages. Leaves get their opacities. Then the levels are made:
// from the finest that a node has to the coarsest, each from the one before by one map of vertices. Space is
// cut into cells that decide for themselves where vertices go, then the map is applied to the pages. Morph
// blocks and pages go to the writer; nodes get their boxes and entries. What the old dataset has of all this
// and is not touched stays. `store`: reads its pages and the writer's.
Result<void> makeLevels(LevelModel& model, const RecordFormat& format, const LevelOptions& options,
                        const OldTree& old, PageStore& store, PageWriter& writer, ChunkFile& spill,
                        Progress& progress);

}  // namespace iwalk
