#pragma once

#include <optional>
#include <string>
#include <vector>

#include "preprocess/build/verify_reader.hpp"
#include "preprocess/build/verify_targets.hpp"

// Inside verifyDataset() only: whether each level follows from the next finer one.
namespace iwalk {

// What is wrong, and where.
struct LevelProblem {
    std::uint32_t page;
    std::string what;
};

class LevelChecker {
  public:
    // `targets`: of all pages.
    LevelChecker(const Hierarchy& hierarchy, PageReader& reader, const TargetTable& targets);

    // Each entry of the node against those of the next finer level that turn into it: their ranges and boxes
    // lie in its ranges, the images of their triangles are there, and what is at full resolution in both
    // agrees with neighbours that move. Problems are added to `problems`, at most one for each pair of
    // entries.
    Result<void> check(std::uint32_t node, std::vector<LevelProblem>& problems);

  private:
    Result<void> checkImages(const NodeRecord& node, std::size_t entry, std::vector<LevelProblem>& problems);
    Result<void> checkHeld(const NodeRecord& node, std::vector<LevelProblem>& problems);

    const Hierarchy& hierarchy_;
    PageReader& reader_;
    const TargetTable& targets_;
    unsigned finestLevel_ = 0;
};

}  // namespace iwalk
