#pragma once

#include <string>

#include "common/dataset/hierarchy.hpp"

// Inside common/dataset only.
namespace iwalk {

inline constexpr std::size_t kHierarchyHeaderBytes = 64;
inline constexpr const char* kHierarchyDamaged =
    "the hierarchy is damaged: copy the dataset again or rebuild it";

// Whether a hierarchy agrees with itself and with its manifest, as loadHierarchy() promises. `path` is for
// messages.
Result<void> checkHierarchy(const std::string& path, const Hierarchy& hierarchy, const Manifest& manifest);

}  // namespace iwalk
