#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/geometry.hpp"
#include "tests/tools/levels/dataset_pages.hpp"

namespace iwalk::levels {

inline constexpr std::uint32_t kNoRange = 0xffffffff;

// Corners are numbered by their place: equal numbers, equal lattice positions.
struct MorphVertex {
    std::uint32_t place, target;  // indices into RangeModel::places
    std::uint32_t between;        // number of this way from place to target, to level `next`
};

// A range that a cut may draw.
struct CutRange {
    LatticeBox box;
    int level = 0;                     // RangeModel::fullLevel() for the input
    int next = -1;                     // the level that its vertices morph to; -1: none
    std::uint32_t parent = kNoRange;   // the range of level `next` whose cell contains its cell
    std::vector<MorphVertex> corners;  // three a triangle
};

// All ranges of all levels of a dataset, in memory, with corners identified by position alone. Positions are
// lattice steps from the root cell's lowest corner, so that double precision is exact.
class RangeModel {
  public:
    // The number that stands for the input's own resolution must be beyond all levels.
    explicit RangeModel(int levels) : levels_(levels) {}
    int levels() const { return levels_; }
    int fullLevel() const { return levels_; }

    // A corner on its way from `place` to `target` in a range whose vertices morph to level `next`.
    MorphVertex vertex(const LatticePoint& place, const LatticePoint& target, int next);
    std::uint32_t add(CutRange range);

    std::vector<CutRange>& ranges() { return ranges_; }
    const std::vector<CutRange>& ranges() const { return ranges_; }
    const std::vector<glm::dvec3>& places() const { return places_; }
    std::uint32_t ways() const { return static_cast<std::uint32_t>(ways_.size()); }
    LatticeBox bounds() const;
    // Of every level the largest diagonal of a range's box, lattice steps. With `input` the input's ranges
    // count for all levels finer than the one they morph to.
    std::vector<double> diagonals(bool input) const;

    std::size_t vanished = 0;  // ranges added for cells whose triangles are all gone at a level

  private:
    std::uint32_t place(const LatticePoint& point);

    using Triple = std::array<std::int64_t, 3>;
    struct Hash {
        std::size_t operator()(const Triple& key) const;
    };
    using Numbers = std::unordered_map<Triple, std::uint32_t, Hash>;

    int levels_;
    std::vector<CutRange> ranges_;
    std::vector<glm::dvec3> places_;
    Numbers numbers_;  // of places
    Numbers ways_;     // of place, target and next level
};

// Reads all of a dataset.
Result<RangeModel> loadRangeModel(const DatasetPages& pages);

}  // namespace iwalk::levels
