#pragma once

#include <oneapi/tbb/task_arena.h>

#include <functional>
#include <span>

#include "preprocess/levels/model.hpp"
#include "preprocess/levels/page_store.hpp"

namespace iwalk {

// Gives every leaf its opacities: from all triangles at full resolution that cross its cell, whosever they
// are (Correa 2004, section 3.2). `records`: of the pages.
Result<void> findOpacities(LevelModel& model, std::span<const PageRecord> records, PageStore& store,
                           tbb::task_arena& arena, const std::function<void(double)>& done);

}  // namespace iwalk
