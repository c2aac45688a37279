#pragma once

#include <vector>

#include "tests/tools/levels/dataset_pages.hpp"
#include "tests/tools/levels/triangle.hpp"

namespace iwalk::levels {

inline constexpr int kGridLog2 = 29;

// Positions on a grid that divides the edge of the root's cell into 2^kGridLog2 parts: exact, and so are
// points half way between two of them, where the edge has at most 2^28 lattice steps; else rounded to the
// grid.
class FixedGrid {
  public:
    explicit FixedGrid(const Hierarchy& hierarchy);
    // Of point / 2, parts from the root cell's lowest corner. Positions may lie up to half the root's edge
    // outside of it.
    Corner ofHalves(const LatticePoint& twice) const;
    // Model units of a part.
    double unit(const Manifest& manifest) const;

  private:
    LatticePoint origin_;
    int log2_;  // of the root's edge in steps
};

// The triangles of the whole model at a level; kFullLevel: the input.
Result<std::vector<FixedTriangle>> levelTriangles(const DatasetPages& pages, const FixedGrid& grid,
                                                  unsigned level);

// The same, half way on its way from the next finer level to `level`: vertices of what is replaced at `level`
// lie in the middle between their position and their morph target.
Result<std::vector<FixedTriangle>> halfMorphTriangles(const DatasetPages& pages, const FixedGrid& grid,
                                                      unsigned level);

}  // namespace iwalk::levels
