#pragma once

#include <oneapi/tbb/task_arena.h>

#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "preprocess/build/packer.hpp"
#include "preprocess/build/page_writer.hpp"
#include "preprocess/levels/large_entry.hpp"
#include "preprocess/levels/level_slice.hpp"
#include "preprocess/levels/levels.hpp"
#include "preprocess/levels/model.hpp"
#include "preprocess/levels/old_targets.hpp"
#include "preprocess/levels/stage.hpp"
#include "preprocess/levels/targets.hpp"

namespace iwalk {

// What the passes share.
struct LevelTools {
    LevelModel& model;
    RecordFormat format;  // of triangles with errors
    std::uint32_t leafTriangles;
    LevelSizes sizes;
    const OldTree& old;
    PageStore& store;
    PageWriter& writer;
    ChunkFile& spill;
    tbb::task_arena& arena;
};

// Applies a map of vertices: writes the morph blocks of the stage's pages, and the pages of the next coarser
// level; of those that the old dataset has already only what is not the same. Goes over the stage's pages
// once; those that the nodes under way need are in memory.
class LevelApplier {
  public:
    LevelApplier(LevelTools& tools, Stage& stage, TargetBins& targets);

    Result<void> run(const std::function<void(double)>& done);

  private:
    // A stage page in memory, and where its vertices go.
    struct Loaded {
        std::shared_ptr<const SourcePage> page;
        PageTargets targets;
        std::vector<std::byte> morph;
        std::vector<LatticeBox> reach;  // by owner: around the places that its vertices go to
    };
    // An entry to be made.
    struct Job {
        std::uint32_t node;
        std::vector<EntrySource> sources;
        std::uint32_t firstPage, lastPage;  // the stage's pages among those that it needs lie in here
        std::uint64_t triangles, vertices;  // of the sources
    };
    // A page of a source.
    struct JobPage {
        std::uint32_t number, firstRange, rangeCount;
        bool held;
        std::uint64_t way;
        unsigned wayLevels;
    };

    std::vector<Job> planJobs();
    Result<void> loadUpTo(std::uint32_t end);
    Result<void> load(std::uint32_t begin, std::uint32_t end);
    Result<void> findTargets(std::uint32_t index);
    void encodeMorph(std::uint32_t index);
    Result<void> writeMorph(std::uint32_t index);
    void startEntry(const Job& job);
    Result<void> makeEntries(std::span<const Job> jobs);
    Result<Slice> makeSlice(const Job& job);
    Result<void> makeLargeEntry(const Job& job, std::uint32_t needed);
    Result<void> writeLargeEntry(const Job& job, LargeEntry& entry);
    std::vector<JobPage> pagesOf(const Job& job) const;
    Result<LevelSource> sourceOf(const JobPage& page, std::shared_ptr<const SourcePage>& held);
    void place(Slice& slice, const Job& job) const;
    unsigned leastLevels(const Job& job) const;
    Result<void> writePages(std::vector<PageJob> pages);
    void release(std::uint32_t end);

    LevelTools& tools_;
    Stage& stage_;
    TargetBins& targets_;
    std::optional<OldTargets> oldTargets_;
    Packer packer_;
    std::deque<Loaded> loaded_;  // stage pages from firstLoaded_ on
    std::uint32_t firstLoaded_ = 0;
};

}  // namespace iwalk
