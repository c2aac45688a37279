#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/build/spill.hpp"
#include "preprocess/levels/decide.hpp"

namespace iwalk {

// Where all vertices of a page go.
struct PageTargets {
    std::vector<CellPoint> positions;
    std::vector<float> errors;                   // steps; of the points they go to
    std::vector<std::uint32_t> colors, normals;  // as the page has them
};

// All vertices stay where they are.
Result<PageTargets> stayingTargets(const Stage& stage, const StagePage& page, const SourcePage& source);

// The targets that cells decide upon, sorted by pages in a spill file. Pages are read again in order.
class TargetBins {
  public:
    TargetBins(ChunkFile& file, const Stage& stage);

    Result<void> add(std::span<const VertexTarget> targets);  // one thread at a time
    // All are added.
    Result<void> finish();
    // Sets those of stage page `index` that were added. Each page once, in order of the index.
    Result<void> take(std::uint32_t index, PageTargets& targets);

  private:
    static constexpr std::size_t kWords = sizeof(VertexTarget) / 4;
    Result<void> load(std::size_t bin);
    void sortByPage(std::size_t bin);

    ChunkFile& file_;
    const Stage& stage_;
    std::vector<std::uint32_t> binOf_;  // by stage page
    BinWriter writer_;
    std::vector<Bin> bins_;
    std::size_t loaded_ = SIZE_MAX;  // bin
    std::vector<VertexTarget> targets_;
    std::vector<std::uint32_t> order_;  // places in targets_, page by page
    std::size_t firstPage_ = 0;         // of the bin
    std::vector<std::size_t> ends_;     // by page of the bin: end of its part of order_
};

}  // namespace iwalk
