#pragma once

#include "preprocess/build/page_job.hpp"

namespace iwalk {

// Edges get at most this many times as long as a level's error: half a cell at the level's depth.
// Flat parts keep some triangles for it, and the boxes of ranges stay small.
inline constexpr float kEdgesPerError = 32;

// The finest level worth making of a node's triangles: the first at which a good part of their vertices,
// looked at in a sample, can go. At least `depth` - 1, which means that no level is between full and that of
// the node's parent.
int finestLevel(const RecordFormat& format, const Slice& slice, int depth);

}  // namespace iwalk
