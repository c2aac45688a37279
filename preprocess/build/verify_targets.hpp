#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry.hpp"

// Inside verifyDataset() only.
namespace iwalk {

// A sample of a dataset's positions, and where each goes on the way to a level: pages that meet must agree.
class TargetTable {
  public:
    // `vertices` at most will come; up to 6 million of them all positions are in the sample, of more an even
    // share. So memory stays below 128 MB.
    explicit TargetTable(std::uint64_t vertices);

    // False when the same position was told to go elsewhere, on its way to the same level.
    bool add(unsigned level, const LatticePoint& position, const LatticePoint& target);
    // Whether nothing that was added says that the position moves.
    bool stays(unsigned level, const LatticePoint& position) const;

  private:
    struct Slot {
        std::uint64_t key = 0, target = 0;  // hashes; no key: free
    };
    bool inSample(std::uint64_t key) const { return skip_ == 0 || key >> (64 - skip_) == 0; }
    std::size_t find(std::uint64_t key) const;

    unsigned skip_ = 0;  // of 2^skip_ positions one is in the sample
    std::size_t used_ = 0;
    std::vector<Slot> slots_;
};

}  // namespace iwalk
