#pragma once

#include <functional>
#include <string>

#include "common/dataset/hierarchy.hpp"
#include "preprocess/build/old_tree.hpp"
#include "preprocess/build/record.hpp"
#include "preprocess/levels/page_store.hpp"

namespace iwalk {

// The dataset that models are inserted into.
struct OldDataset {
    Manifest manifest;
    LevelModel model;
    std::vector<PageRecord> pages;
};
Result<OldDataset> loadOldDataset(const std::string& path);

// The paths of the dataset's pages files, in the order of the manifest.
std::vector<std::string> pagePaths(const std::string& dataset, const Manifest& manifest);

// Gives the full resolution of all nodes that are touched to `add`, in steps from the root cell of the
// store's lattice.
Result<void> readTouched(const OldDataset& old, const OldTree& tree, PageStore& store,
                         const std::function<Result<void>(const TriangleRecord&)>& add,
                         const std::function<void(double)>& done);

}  // namespace iwalk
