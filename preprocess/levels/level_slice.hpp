#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/build/page_job.hpp"
#include "preprocess/levels/cell_runs.hpp"
#include "preprocess/levels/numbers.hpp"
#include "preprocess/levels/page_store.hpp"
#include "preprocess/levels/targets.hpp"

namespace iwalk {

// Ranges of a page that belong to one entry, on their way into an entry of the next coarser level.
struct LevelSource {
    const SourcePage* page;
    const PageTargets* targets;  // nullptr: all stay where they are
    std::uint32_t firstRange, rangeCount;
    // The entry's node in the cell of the one that the level is made for: octants on the way down, 3 bits
    // each.
    std::uint64_t way;
    unsigned wayLevels;
};

// What becomes of ranges' triangles: those that have become a line or a point are left out, and of triangles
// that have become equal only as many stay as it takes to keep the surface's border what it was. One range at
// a time: equal triangles of different ranges both stay, since one may be drawn finer than the other.
class RangeImages {
  public:
    // `errorLimit`: of the level that is made, steps.
    RangeImages(const RecordFormat& format, const Lattice& lattice, float errorLimit)
        : format_(format), lattice_(lattice), errorLimit_(errorLimit) {}

    // Appends the triangles' records, and says how many they are and whose they will be.
    RunSource add(const LevelSource& source, const Range& range, std::vector<std::uint32_t>& records);
    // A triangle that is a point of the range: what an entry has of which nothing is left, to keep its place.
    void addPoint(const LevelSource& source, const Range& range, std::vector<std::uint32_t>& records) const;

  private:
    // A triangle of the image.
    struct Image {
        std::array<std::uint32_t, 3> points;  // numbers, ascending
        std::uint32_t triangle;               // its place in the order
        bool turned;                          // ascending order turned it over
    };
    LatticeBox boxOf(const LevelSource& source, const Range& range) const;
    void addImage(const LevelSource& source, std::uint32_t first);
    void removeEqual();
    std::uint8_t errorOf(float error) const;
    void addRecord(const LevelSource& source, const std::array<std::uint32_t, 3>& corners,
                   std::vector<std::uint32_t>& records) const;

    const RecordFormat& format_;
    const Lattice& lattice_;
    float errorLimit_;
    Numbers<CellPoint, PointHash> points_;
    std::vector<Image> images_;
};

// The image of the sources' triangles as one entry. Triangles come in the order of their cells; ranges are
// smaller than `leastLevels` below the entry's cell unless they have few triangles.
Slice makeLevelSlice(const RecordFormat& format, const Lattice& lattice, std::span<const LevelSource> sources,
                     float errorLimit, unsigned leastLevels);

}  // namespace iwalk
