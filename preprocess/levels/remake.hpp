#pragma once

#include <vector>

#include "preprocess/build/old_tree.hpp"
#include "preprocess/levels/model.hpp"
#include "preprocess/levels/stage.hpp"

namespace iwalk {

// Gives each node its entry of the stage's level that the old dataset has already: when nothing that it is
// made from is new or goes elsewhere, and its page holds no other entry that must be made again. The result
// says by node whether an entry must be made.
std::vector<bool> keepEntries(LevelModel& model, const Stage& stage, const OldTree& old);

}  // namespace iwalk
