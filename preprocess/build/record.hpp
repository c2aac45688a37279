#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "preprocess/build/lattice.hpp"

namespace iwalk {

// A triangle on the lattice.
struct TriangleRecord {
    std::array<CellPoint, 3> positions;
    std::array<std::uint32_t, 3> colors{};   // RGBA8
    std::array<std::uint32_t, 3> normals{};  // packNormal()
    std::array<std::uint8_t, 3> errors{};    // of a coarser level, in 255ths of its limit
};

// How triangles are kept while they are sorted, in memory and in the spill file: as few 32-bit words as the
// model allows. Nine for positions (eighteen where the root cell is larger than 2^32 steps), three each for
// attributes, one for errors.
class RecordFormat {
  public:
    RecordFormat(unsigned rootCellLog2, bool colors, bool normals, bool errors = false)
        : rootCellLog2_(rootCellLog2),
          wide_(rootCellLog2 > 32),
          colors_(colors),
          normals_(normals),
          errors_(errors),
          attributes_(wide_ ? 18 : 9),
          words_(attributes_ + (colors ? 3u : 0u) + (normals ? 3u : 0u) + (errors ? 1u : 0u)) {}

    std::size_t words() const { return words_; }
    std::size_t bytes() const { return words_ * sizeof(std::uint32_t); }
    unsigned rootCellLog2() const { return rootCellLog2_; }

    void pack(const TriangleRecord& triangle, std::uint32_t* out) const {
        std::size_t at = 0;
        for (const CellPoint& p : triangle.positions) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                out[at++] = static_cast<std::uint32_t>(p[axis]);
                if (wide_) out[at++] = static_cast<std::uint32_t>(p[axis] >> 32);
            }
        }
        if (colors_) std::memcpy(out + at, triangle.colors.data(), 12);
        if (normals_) std::memcpy(out + at + (colors_ ? 3 : 0), triangle.normals.data(), 12);
        if (errors_) std::memcpy(out + words_ - 1, triangle.errors.data(), 3);
    }

    CellPoint position(const std::uint32_t* record, std::size_t corner) const {
        if (!wide_) return CellPoint(record[3 * corner], record[3 * corner + 1], record[3 * corner + 2]);
        std::array<std::uint64_t, 3> p{};
        std::memcpy(p.data(), record + 6 * corner, sizeof(p));
        return CellPoint(p[0], p[1], p[2]);
    }
    // 0 when the model has none.
    std::uint32_t color(const std::uint32_t* record, std::size_t corner) const {
        return colors_ ? record[attributes_ + corner] : 0;
    }
    std::uint32_t normal(const std::uint32_t* record, std::size_t corner) const {
        return normals_ ? record[attributes_ + (colors_ ? 3u : 0u) + corner] : 0;
    }
    std::uint8_t error(const std::uint32_t* record, std::size_t corner) const {
        return errors_ ? static_cast<std::uint8_t>(record[words_ - 1] >> 8 * corner) : std::uint8_t{0};
    }
    bool hasErrors() const { return errors_; }
    TrianglePlace place(const std::uint32_t* record) const {
        return placeOf(position(record, 0), position(record, 1), position(record, 2), rootCellLog2_);
    }

  private:
    unsigned rootCellLog2_;
    bool wide_, colors_, normals_, errors_;
    std::size_t attributes_, words_;
};

}  // namespace iwalk
