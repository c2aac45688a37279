#pragma once

#include <unordered_map>
#include <vector>

#include "preprocess/build/old_tree.hpp"
#include "preprocess/build/page_writer.hpp"
#include "preprocess/levels/stage.hpp"
#include "preprocess/levels/targets.hpp"

namespace iwalk {

// Where the vertices of the old dataset's pages went on the way to one level.
class OldTargets {
  public:
    OldTargets(const OldTree& old, const LevelModel& model, const PageWriter& writer, PageStore& store,
               unsigned level);

    // Of a page that has a morph block. Its errors are bounds: pages do not say those of single vertices.
    Result<PageTargets> of(const StagePage& page, const SourcePage& source) const;

  private:
    Result<void> addOwner(const PageOwner& owner, const SourcePage& source, PageTargets& targets) const;
    const LevelRecord& coarserEntry(std::uint32_t node) const;

    const OldTree& old_;
    const LevelModel& model_;
    const PageWriter& writer_;
    PageStore& store_;
    unsigned level_;                      // of the old dataset
    std::vector<std::uint32_t> parents_;  // of its nodes
};

}  // namespace iwalk
