#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <random>
#include <vector>

#include "tests/tools/bvh.hpp"
#include "tests/tools/levels/range_model.hpp"

namespace iwalk::levels {

// The share of the distance to a level in which it blends into the next.
inline constexpr double kBlendShare = 0.3;
// Of a level's distance, the most that a range's diagonal may measure.
inline constexpr double kDiagonalShare = 0.36;

// S_l, the distance (lattice steps) beyond which level l is drawn. `errors`: of levels from 0 on, lattice
// steps; `scale`: px at distance 1 of something of size 1; `screenError`: px.
std::vector<double> levelDistances(const std::vector<double>& errors, const std::vector<double>& diagonals,
                                   double scale, double screenError);

// An eye that sees the model: half of all in its box, the others up to four diagonals away from its centre.
glm::dvec3 randomEye(std::mt19937_64& random, const LatticeBox& box);
double logUniform(std::mt19937_64& random, double low, double high);

// What a cut drew.
struct Cut {
    std::uint64_t triangles = 0, openEdges = 0;
    int levels = 0;  // different ones, the input's own resolution included
};

// Draws cuts, as far as their edges go. Keeps a reference to the model.
class CutDrawer {
  public:
    explicit CutDrawer(const RangeModel& model) : model_(model) {}
    // As seen from `eye` (as places), with level distances S_l.
    Cut draw(const glm::dvec3& eye, const std::vector<double>& distances);
    // The whole input.
    Cut drawFull();
    // The triangles of the same cut where they are drawn.
    std::vector<tools::Triangle> triangles(const glm::dvec3& eye, const std::vector<double>& distances) const;

  private:
    bool isDrawn(const CutRange& range, const glm::dvec3& eye, const std::vector<double>& distances) const;
    glm::dvec3 drawnAt(const MorphVertex& vertex, const glm::dvec3& eye, double distance) const;
    std::uint32_t cornerAt(const MorphVertex& vertex, const glm::dvec3& eye, double distance) const;

    const RangeModel& model_;
    std::vector<std::uint32_t> corners_;  // of the latest cut
};

// Which ranges' diagonals hold levels' distances up. That no cut has a crack needs those of the levels alone:
// where the input is drawn, finer levels leave its vertices where they are.
enum class Diagonals { kNone, kLevels, kLevelsAndInput };

struct CrackOptions {
    std::size_t pairs = 1000;
    std::uint64_t seed = 1;
    Diagonals diagonals = Diagonals::kLevels;
    double scale = 900;                                 // px
    double minScreenError = 0.05, maxScreenError = 20;  // px; log-uniform in between
};

struct CrackReport {
    Cut full;  // the input as it is; for the cuts it is closed (close_input.hpp), a triangle an open edge //
               // open edges of the input
    std::uint64_t openEdges = 0;                          // of all cuts
    std::size_t openCuts = 0;                             // cuts with an open edge
    std::size_t twoLevels = 0, moreLevels = 0;            // cuts that mix 2, and 3 or more levels
    std::uint64_t triangles = 0;                          // drawn, of all cuts
    std::uint64_t leastTriangles = 0, mostTriangles = 0;  // of a cut
    std::size_t vanished = 0;                             // cells that have nothing at the next coarser level
    std::size_t looseBoxes = 0;  // ranges whose box is not inside that of the coarser range around them
};

// `errors` as for levelDistances().
CrackReport countCracks(RangeModel model, const std::vector<double>& errors, const CrackOptions& options);

}  // namespace iwalk::levels
