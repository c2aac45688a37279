#include "preprocess/generate/spline_octave.hpp"

#include <algorithm>

#include "preprocess/generate/random.hpp"

namespace iwalk {
namespace {

constexpr std::int32_t kNowhere = -1;

// [-1, 1), exact.
float signedUnit(std::uint32_t bits) {
    return static_cast<float>(static_cast<std::int32_t>(bits)) * 0x1p-31f;
}

}  // namespace

SplineOctave::SplineOctave(std::uint32_t seed, double cells, const IsosurfaceGrid& grid)
    : seed_(seed), scale_(cells / grid.cells), scaleZ_(cells * grid.stepZ() / kLayerSide) {
    planeAt_.fill(kNowhere);
    for (std::size_t y = 0; y < grid.stride(); ++y) {
        const Place at = place(static_cast<double>(std::min<std::size_t>(y, grid.cells)) * scale_);
        cellOf_.push_back(static_cast<std::uint32_t>(at.cell));
        weightsOfY_.push_back(weightsOf(at.fraction));
    }
    latticeY_ = std::size_t{cellOf_.back()} + 4;
    latticeZ_ = static_cast<std::size_t>(place(grid.layers * scaleZ_).cell) + 4;
    for (std::vector<float>& plane : planes_) plane.resize(latticeZ_ * latticeY_);
    plane_.resize(latticeZ_ * latticeY_);
    for (std::vector<float>& line : lines_) line.resize(grid.stride());
}

// Coordinates are not negative.
SplineOctave::Place SplineOctave::place(double coordinate) {
    const std::int32_t cell = static_cast<std::int32_t>(coordinate);
    return {cell, static_cast<float>(coordinate - cell)};
}

// Of the four lattice points around a place, which is `t` beyond the second.
SplineOctave::Weights SplineOctave::weightsOf(float t) {
    const float s = 1 - t;
    const float a = s * s * s / 6, d = t * t * t / 6;
    const float c = (((-3 * t + 3) * t + 3) * t + 1) / 6;
    return {a, 1 - a - c - d, c, d};
}

void SplineOctave::fillPlane(std::int32_t x, std::vector<float>& plane) const {
    const std::uint32_t base = scramble32(seed_ + static_cast<std::uint32_t>(x) * 0x9e3779b9u);
    for (std::size_t z = 0; z < latticeZ_; ++z) {
        const std::uint32_t line = scramble32(base + static_cast<std::uint32_t>(z) * 0x85ebca77u);
        float* out = &plane[z * latticeY_];
        for (std::uint32_t y = 0; y < latticeY_; ++y) {
            out[y] = signedUnit(scramble32(line + y * 0xc2b2ae3du));
        }
    }
}

void SplineOctave::slab(std::uint32_t x) {
    const Place at = place(x * scale_);
    std::array<const float*, 4> from{};
    for (std::int32_t i = 0; i < 4; ++i) {
        const std::size_t slot = static_cast<std::size_t>(at.cell + i) % 4;
        if (planeAt_[slot] != at.cell + i) fillPlane(planeAt_[slot] = at.cell + i, planes_[slot]);
        from[static_cast<std::size_t>(i)] = planes_[slot].data();
    }
    const Weights w = weightsOf(at.fraction);
    for (std::size_t i = 0; i < plane_.size(); ++i) {
        plane_[i] = w[0] * from[0][i] + w[1] * from[1][i] + w[2] * from[2][i] + w[3] * from[3][i];
    }
    lineAt_.fill(kNowhere);
}

void SplineOctave::fillLine(std::size_t z, std::vector<float>& line) const {
    const float* lattice = &plane_[z * latticeY_];
    for (std::size_t y = 0; y < line.size(); ++y) {
        const float* from = lattice + cellOf_[y];
        const Weights& w = weightsOfY_[y];
        line[y] = w[0] * from[0] + w[1] * from[1] + w[2] * from[2] + w[3] * from[3];
    }
}

SplineOctave::Row SplineOctave::row(std::uint32_t z) {
    const Place at = place(z * scaleZ_);
    const Weights weights = weightsOf(at.fraction);
    Row row;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::int32_t lattice = at.cell + static_cast<std::int32_t>(i);
        const std::size_t slot = static_cast<std::size_t>(lattice) % 4;
        if (lineAt_[slot] != lattice) {
            lineAt_[slot] = lattice;
            fillLine(static_cast<std::size_t>(lattice), lines_[slot]);
        }
        row.lines_[i] = lines_[slot].data();
        row.weights_[i] = fourOf(weights[i]);
    }
    return row;
}

}  // namespace iwalk
