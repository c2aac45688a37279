// A coarse search by the number of cells, then a fine one by the amplitude of the mixing. Triangles are
// counted on some slabs, evenly spread over the layer, or on all of them when they are few.
#include "preprocess/generate/isosurface_size.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "preprocess/generate/mixing_field.hpp"
#include "preprocess/generate/surface_cells.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kSlabs = 48;          // counted on large grids
constexpr std::uint32_t kCountedWhole = 160;  // cells; smaller grids are counted on every slab
constexpr std::uint32_t kLeastCells = 6;
constexpr std::uint32_t kSmallGrid = 64;  // cells
constexpr double kTolerance = 0.002;
constexpr int kCoarseSteps = 7, kFineSteps = 12;
constexpr double kMostAmplitude = 1.5;

class Counter {
  public:
    Counter(std::uint64_t seed, double wanted, Progress& progress)
        : seed_(seed), wanted_(wanted), progress_(progress), table_(makeCubeTable()) {}

    // Triangles as a share of what is wanted.
    double operator()(const IsosurfaceGrid& grid) {
        MixingField field(seed_, grid);
        std::vector<float> values(grid.rows() * grid.stride());
        const std::uint32_t slabs = grid.cells <= kCountedWhole ? grid.cells : kSlabs;
        std::uint64_t triangles = 0;
        std::array<Signs, 2> signs;
        for (std::uint32_t i = 0; i < slabs; ++i) {
            const auto x = static_cast<std::uint32_t>((2 * std::uint64_t{i} + 1) * grid.cells / (2 * slabs));
            for (std::uint32_t side = 0; side < 2; ++side) {
                field.slab(x + side, values);
                findSigns(grid, values, signs[side]);
            }
            forCrossedCells(grid, signs[0], signs[1], [&](std::size_t, std::size_t, unsigned inside) {
                triangles += table_[inside].triangles.size();
            });
        }
        progress_.done(static_cast<double>(++counts_) / (kCoarseSteps + kFineSteps));
        return static_cast<double>(triangles) * grid.cells / slabs / wanted_;
    }

  private:
    std::uint64_t seed_;
    double wanted_;
    Progress& progress_;
    CubeTable table_;
    int counts_ = 0;
};

// The root of degree 2^halvings, by an operation that is exact to the last bit everywhere.
double root(double n, int halvings) {
    for (int i = 0; i < halvings; ++i) n = std::sqrt(n);
    return n;
}
double threeEighths(double n) {
    return root(n, 3) * root(n, 3) * root(n, 3);
}

// Cells that gave as many triangles, within some percent from 10^6 to 10^8.
double guessCells(double triangles) {
    return 2.308 * threeEighths(triangles) / root(triangles, 6);
}

// The finest grid that has not too many triangles, and their share of what is wanted. Their number grows
// about with the 8/3rd power of the cells.
std::pair<IsosurfaceGrid, double> findCells(Counter& count, double wanted) {
    double cells = guessCells(wanted), lowShare = 0;
    std::uint32_t low = kLeastCells, high = UINT32_MAX;
    for (int i = 0; i < kCoarseSteps && high - low > 1; ++i) {
        const auto tried = std::clamp(static_cast<std::uint32_t>(cells), low, high - 1);
        const double share = count(IsosurfaceGrid::of(tried, 1));
        if (share > 1) {
            high = tried;
        } else {
            low = tried, lowShare = share;
            if (share > 1 - 3.0 / tried) break;
        }
        cells = tried * threeEighths(1 / share);
        if (cells <= low || cells >= high) cells = low + (high - low) / 2;
    }
    const IsosurfaceGrid grid = IsosurfaceGrid::of(low, 1);
    return {grid, lowShare > 0 ? lowShare : count(grid)};
}

struct Candidate {
    IsosurfaceGrid grid;
    double share = 0;  // of the triangles wanted
    double miss() const { return std::abs(share - 1); }
};

// Makes up for what is missing by the amplitude.
Candidate findAmplitude(Counter& count, Candidate best) {
    Candidate tried = best;
    double low = 1, high = kMostAmplitude;
    for (int i = 0; i < kFineSteps && best.miss() > kTolerance; ++i) {
        // The number of triangles grows about with the amplitude; halving where that leads nowhere.
        const double guess = tried.grid.amplitude + (1 - tried.share);
        tried.grid.amplitude = i % 3 != 2 && guess > low && guess < high ? guess : (low + high) / 2;
        tried.share = count(tried.grid);
        (tried.share < 1 ? low : high) = tried.grid.amplitude;
        if (tried.miss() < best.miss()) best = tried;
    }
    return best;
}

// On small grids the number of triangles jumps up and down with the amplitude: tries many, on several grids.
Candidate tryMany(Counter& count, Candidate best) {
    const std::uint32_t middle = best.grid.cells;
    for (std::uint32_t cells = middle - 2; cells <= middle + 2; ++cells) {
        for (int i = 0; i <= 60 && best.miss() > kTolerance; ++i) {
            const IsosurfaceGrid grid = IsosurfaceGrid::of(cells, 0.8 + 0.01 * i);
            const Candidate tried{grid, count(grid)};
            if (tried.miss() < best.miss()) best = tried;
        }
    }
    return best;
}

}  // namespace

IsosurfaceGrid findIsosurfaceGrid(std::uint64_t triangles, std::uint64_t seed, Progress& progress) {
    const double wanted = static_cast<double>(triangles);
    Counter count(seed, wanted, progress);
    const auto [grid, share] = findCells(count, wanted);
    Candidate best = findAmplitude(count, {grid, share});
    if (best.miss() > kTolerance && grid.cells < kSmallGrid) best = tryMany(count, best);
    return best.grid;
}

}  // namespace iwalk
