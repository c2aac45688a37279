#pragma once

#include <cstddef>
#include <cstdint>

namespace iwalk {

inline constexpr double kLayerSide = 100;  // of the square that the mixing layer lies on, model units
inline constexpr double kLayerHalfHeight =
    16;  // the layer ends at these heights above and below 0, model units

// The grid that the isosurface is found on. Points of one x are a slab, those of one x and z a row; in a row
// y runs, in words of 64 points, the last one padded.
struct IsosurfaceGrid {
    std::uint32_t cells = 0;   // along x and along y
    std::uint32_t layers = 0;  // cells along z
    double amplitude = 1;      // of the mixing: the more, the more triangles

    static IsosurfaceGrid of(std::uint32_t cells, double amplitude) {
        const double layers = 2 * kLayerHalfHeight / (kLayerSide / cells);
        return {cells, static_cast<std::uint32_t>(layers) + 1, amplitude};
    }
    double step() const { return kLayerSide / cells; }              // along x and y, model units
    double stepZ() const { return 2 * kLayerHalfHeight / layers; }  // model units
    std::size_t rows() const { return std::size_t{layers} + 1; }    // in a slab
    std::size_t words() const { return cells / 64 + 1; }            // in a row
    std::size_t stride() const { return words() * 64; }             // points in a row, padding included
    // The bits of a row's word that stand for points, for edges along y, for cells.
    std::uint64_t points(std::size_t word) const { return bitsBelow(std::size_t{cells} + 1, word); }
    std::uint64_t edges(std::size_t word) const { return bitsBelow(cells, word); }

  private:
    static std::uint64_t bitsBelow(std::size_t count, std::size_t word) {
        const std::size_t here = count - 64 * word;
        return here >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << here) - 1;
    }
};

}  // namespace iwalk
