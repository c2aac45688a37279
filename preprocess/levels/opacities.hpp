#pragma once

#include <oneapi/tbb/task_arena.h>

#include <functional>
#include <span>

#include "preprocess/build/old_tree.hpp"
#include "preprocess/levels/model.hpp"
#include "preprocess/levels/page_store.hpp"

namespace iwalk {

// Gives every leaf its opacities: from all triangles at full resolution that cross its cell, whosever they
// are (Correa 2004, section 3.2). `records`: of the pages. Leaves of the old tree that no change to it
// reaches have theirs.
Result<void> findOpacities(LevelModel& model, std::span<const PageRecord> records, const OldTree& old,
                           PageStore& store, tbb::task_arena& arena, const std::function<void(double)>& done);

}  // namespace iwalk
