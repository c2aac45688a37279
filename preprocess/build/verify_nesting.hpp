#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/build/verify_reader.hpp"

// Inside verifyDataset() only.
namespace iwalk {

// A cell below a node, also by way of a child's path.
struct CellPlace {
    std::uint64_t key;  // the lowest of the Morton keys in it, of kKeyLevels levels
    unsigned levels;    // below the node

    static constexpr unsigned kKeyLevels = 16;
    // Of a path below the node, or, with an octant, below that child.
    static CellPlace of(std::uint32_t path);
    static CellPlace of(unsigned octant, std::uint32_t path);

    bool contains(const CellPlace& inner) const;
    auto operator<=>(const CellPlace&) const = default;
};

// The ranges of an entry, which ranges of the next finer level lie in.
class CoarseRanges {
  public:
    // In order.
    void add(const CellPlace& place, const LatticeBox& box) { ranges_.push_back({place, box}); }

    struct Found {
        bool contained;  // in the cell
        bool boxed;      // and the box in that of the range
    };
    // A finer range is in the last one that begins at or before it and contains it, or else, when nothing is
    // left of it, in the one before it, or the first. Of ranges of one cell any may have it. With no ranges
    // there is nothing to be in.
    Found find(const CellPlace& place, const LatticeBox& box) const;

  private:
    struct Coarse {
        CellPlace place;
        LatticeBox box;
    };
    std::span<const Coarse> rangesAt(const CellPlace& place) const;

    std::vector<Coarse> ranges_;
};

}  // namespace iwalk
