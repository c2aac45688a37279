#pragma once

#include <cstdint>
#include <vector>

#include "common/dataset/hierarchy.hpp"

namespace iwalk {

// The set of (node, level) that covers the model once: of each node at most one entry is drawn. Below an
// entry that is of all that its node contains (Hierarchy::isWhole) nothing is.
struct Cut {
    static constexpr std::uint32_t kNothing = 0xffffffff;
    std::vector<std::uint32_t> entry;  // by node: index in Hierarchy::entries, or kNothing
};

// All of the model at one level; where the dataset has nothing as fine, and with kFullLevel, the input.
Cut cutAtLevel(const Hierarchy& hierarchy, unsigned level);

}  // namespace iwalk
