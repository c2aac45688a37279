#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "preprocess/opacity/cell_opacity.hpp"

namespace {

using Corners = std::vector<glm::vec3>;

// Triangles of about `size` (in cells) anywhere in a cell.
Corners soup(std::size_t triangles, float size) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> place(size, 1 - size), offset(-size / 2, size / 2);
    Corners corners;
    for (std::size_t i = 0; i < triangles; ++i) {
        const glm::vec3 center(place(random), place(random), place(random));
        for (int corner = 0; corner < 3; ++corner)
            corners.push_back(center + glm::vec3(offset(random), offset(random), offset(random)));
    }
    return corners;
}

// Nanoseconds a triangle for all masks; range(0): size in thousandths of the cell; range(1): triangles.
void addSoup(benchmark::State& state) {
    const Corners corners =
        soup(static_cast<std::size_t>(state.range(1)), static_cast<float>(state.range(0)) / 1000);
    iwalk::CellOpacity cell;
    for (auto _ : state) {
        cell.clear();
        cell.add(corners);
        benchmark::DoNotOptimize(cell.coefficients());
    }
    state.counters["triangles"] =
        benchmark::Counter(static_cast<double>(state.range(1)),
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(addSoup)->ArgsProduct({{2, 5, 10, 20, 40, 80, 300}, {1000, 16000}});

}  // namespace

BENCHMARK_MAIN();
