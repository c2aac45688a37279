#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "preprocess/levels/cells.hpp"
#include "preprocess/levels/collapse.hpp"
#include "preprocess/levels/model.hpp"

namespace iwalk {

// Whose a page's ranges are.
struct PageOwner {
    std::uint32_t node;
    std::uint32_t firstRange, rangeCount;
    bool whole;  // an entry of everything below the node
};

// A page with a part in the level that is to be made coarser.
struct StagePage {
    std::uint32_t number = 0;
    PageRecord record{};
    bool held = false;          // its nodes stay at full resolution, so its vertices stay where they are
    CellPoint low{0}, high{0};  // inclusive: contains its vertices
    std::vector<PageOwner> owners;
    std::vector<std::uint8_t> errors;  // by vertex, in 255ths of the level's error; empty: all 0
};

// What the pass that makes one level works on: the next finer level, M_(level + 1), as it lies in pages.
struct Stage {
    unsigned level = 0;  // to be made
    // Those that change first, in depth-first order of their nodes; then those held.
    std::vector<StagePage> pages;
    std::size_t changing = 0;                                 // pages before this place are not held
    std::unordered_map<std::uint32_t, std::uint32_t> places;  // in `pages`, by page number
    std::vector<Weight> weights;                              // of what changes
    float errorUnit = 0;                                      // steps; what StagePage::errors are parts of
    CollapseLimits limits{};
};

// `records`: of the pages so far.
Stage makeStage(const LevelModel& model, unsigned level, std::span<const PageRecord> records);

}  // namespace iwalk
