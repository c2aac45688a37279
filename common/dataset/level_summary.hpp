#pragma once

#include <vector>

#include "common/dataset/hierarchy.hpp"

namespace iwalk {

// What the manifest says of levels; `levels` from level 0 to the finest that an entry has.
struct LevelSummaries {
    std::vector<LevelSummary> levels;
    LevelSummary full;
    bool operator==(const LevelSummaries&) const = default;
};

// Of a hierarchy whose entries are good.
LevelSummaries summariseLevels(const Hierarchy& hierarchy, int stepExponent);

}  // namespace iwalk
