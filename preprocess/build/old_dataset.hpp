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

// Whether what the dataset has can stay where its root's cell is to be this large: a root's cell of more than
// 2^32 steps has entries in cells of 2^28 and less only (common/dataset/hierarchy.hpp).
bool fitsSparse(const OldDataset& old, unsigned rootCellLog2);

// The middle of the root's cell; where that is larger than 2^32 steps, of the cell with most of the
// triangles.
LatticePoint middleOf(const LevelModel& model);

// The paths of the dataset's pages files, in the order of the manifest.
std::vector<std::string> pagePaths(const std::string& dataset, const Manifest& manifest);

// Gives the full resolution of all nodes that are touched to `add`, in steps from the root cell of the
// store's lattice.
Result<void> readTouched(const OldDataset& old, const OldTree& tree, PageStore& store,
                         const std::function<Result<void>(const TriangleRecord&)>& add,
                         const std::function<void(double)>& done);

}  // namespace iwalk
