#pragma once

#include <vector>

#include "preprocess/build/old_tree.hpp"
#include "preprocess/levels/model.hpp"
#include "preprocess/levels/page_store.hpp"
#include "preprocess/levels/stage.hpp"

namespace iwalk {

// The cells that a pass must decide: those in which a triangle of the stage is new, and those that the old
// dataset's pass for the level did not have. In all others vertices can go where they went before, since the
// vertices at cells' borders stay where they are.
Result<std::vector<SpaceCell>> chooseCells(const LevelModel& model, const Stage& stage, const OldTree& old,
                                           const PageWriter& writer, PageStore& store);

}  // namespace iwalk
