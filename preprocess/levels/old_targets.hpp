#pragma once

#include <optional>
#include <vector>

#include "preprocess/build/old_tree.hpp"
#include "preprocess/build/page_writer.hpp"
#include "preprocess/levels/stage.hpp"
#include "preprocess/levels/targets.hpp"

namespace iwalk {

// The level that the old dataset made where `level` is made now; nullopt: none.
std::optional<unsigned> oldLevel(const OldTree& old, unsigned level);

// The old dataset's entry that an owner of a page in the stage had in the place of the one that it has now:
// the same node's, that took the same way to the level. nullptr: none; of what is new also where it is too
// large to be compared.
const LevelRecord* oldSource(const OldTree& old, const LevelModel& model, const Stage& stage,
                             const StagePage& page, const PageOwner& owner);

// Where the vertices of the old dataset's pages went on the way to one level.
class OldTargets {
  public:
    // `level`: of the old dataset.
    OldTargets(const OldTree& old, const LevelModel& model, const PageWriter& writer, PageStore& store,
               unsigned level);

    // Moves the page's vertices that are not decided to where they went before, or to where those went that
    // its nodes' old pages had in their place. Errors are bounds: pages do not say those of single vertices.
    Result<void> set(const Stage& stage, const StagePage& page, const SourcePage& source,
                     const std::vector<bool>& decided, PageTargets& targets) const;

  private:
    struct Known;
    Result<void> addKnown(std::uint32_t oldNode, std::uint32_t number, const SourcePage& page,
                          std::uint32_t firstRange, std::uint32_t rangeCount, Known& known) const;
    Result<PageTargets> ofPage(std::uint32_t number, const SourcePage& source) const;
    Result<void> addAttributes(std::uint32_t oldNode, const SourcePage& source, std::uint32_t firstRange,
                               std::uint32_t rangeCount, PageTargets& targets) const;
    const LevelRecord& coarserEntry(std::uint32_t oldNode) const;

    const OldTree& old_;
    const LevelModel& model_;
    const PageWriter& writer_;
    PageStore& store_;
    unsigned level_;
    std::vector<std::uint32_t> parents_;  // of old nodes
};

}  // namespace iwalk
