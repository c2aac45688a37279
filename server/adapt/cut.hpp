#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/hierarchy.hpp"

namespace iwalk {

// The set of (node, level) that covers the model once. Datasets hold only the full resolution so far, so a
// node is either in the cut with its own triangles or adds nothing.
struct Cut {
    std::vector<bool> drawn;  // by node
};

Cut fullResolution(const Hierarchy& hierarchy);

}  // namespace iwalk
