#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "preprocess/build/page_writer.hpp"
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
    bool fresh = false;         // not of the dataset that is inserted into
    bool moved = false;         // of it, but its vertices go elsewhere now
    bool needed = false;        // an entry is made of it
    CellPoint low{0}, high{0};  // inclusive: contains its vertices
    std::vector<PageOwner> owners;
    float error = 0;  // steps; of all vertices that Stage::errors does not know
};

// What the pass that makes one level works on: the next finer level, M_(level + 1), as it lies in pages.
struct Stage {
    unsigned level = 0;  // to be made
    // Those that change first, in depth-first order of their nodes; then those held.
    std::vector<StagePage> pages;
    std::size_t changing = 0;                                 // pages before this place are not held
    std::unordered_map<std::uint32_t, std::uint32_t> places;  // in `pages`, by page number
    std::vector<SpaceCell> cells;          // that are decided; elsewhere vertices go where they went before
    const VertexErrors* errors = nullptr;  // by page number, in 255ths of errorUnit
    float errorUnit = 0;                   // steps
    CollapseLimits limits{};
};

// But for its cells. `writer`: of the pages so far; gives up what it knows of vertices' errors.
Stage makeStage(const LevelModel& model, unsigned level, PageWriter& writer);

// The entry of the node that turns into one of `level`, when its vertices may move on the way; nullptr: none.
const LevelRecord* changingEntry(const LevelModel& model, std::uint32_t node, unsigned level);
// Whether the node's own triangles are at full resolution and stay there on the way to `level`.
bool isHeld(const LevelModel& model, std::uint32_t node, unsigned level);
CollapseLimits limitsAt(unsigned rootCellLog2, unsigned level);

}  // namespace iwalk
