#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "common/dataset/hierarchy.hpp"
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
// model allows. Nine for positions (twelve where the root cell is larger than 2^32 steps: of the second and
// third corner the way from the first, less than 2^31 steps), three each for attributes, one for errors.
class RecordFormat {
  public:
    RecordFormat(unsigned rootCellLog2, bool colors, bool normals, bool errors = false)
        : rootCellLog2_(rootCellLog2),
          wide_(rootCellLog2 > kMostWholeLog2),
          colors_(colors),
          normals_(normals),
          errors_(errors),
          attributes_(wide_ ? 12 : 9),
          words_(attributes_ + (colors ? 3u : 0u) + (normals ? 3u : 0u) + (errors ? 1u : 0u)) {}

    std::size_t words() const { return words_; }
    std::size_t bytes() const { return words_ * sizeof(std::uint32_t); }
    unsigned rootCellLog2() const { return rootCellLog2_; }

    void pack(const TriangleRecord& triangle, std::uint32_t* out) const {
        const CellPoint& first = triangle.positions[0];
        if (wide_) {
            std::memcpy(out, &first, kFirstWords * sizeof(std::uint32_t));
            for (std::size_t i = 0; i < 6; ++i) {
                out[kFirstWords + i] =
                    static_cast<std::uint32_t>(triangle.positions[1 + i / 3][i % 3] - first[i % 3]);
            }
        } else {
            for (std::size_t i = 0; i < 9; ++i)
                out[i] = static_cast<std::uint32_t>(triangle.positions[i / 3][i % 3]);
        }
        if (colors_) std::memcpy(out + attributes_, triangle.colors.data(), 12);
        if (normals_) std::memcpy(out + attributes_ + (colors_ ? 3 : 0), triangle.normals.data(), 12);
        if (errors_) std::memcpy(out + words_ - 1, triangle.errors.data(), 3);
    }

    CellPoint position(const std::uint32_t* record, std::size_t corner) const {
        if (!wide_) return CellPoint(record[3 * corner], record[3 * corner + 1], record[3 * corner + 2]);
        CellPoint p;
        std::memcpy(&p, record, kFirstWords * sizeof(std::uint32_t));
        for (glm::length_t axis = 0; axis < 3 && corner > 0; ++axis) {
            const std::uint32_t way = record[kFirstWords + 3 * (corner - 1) + static_cast<std::size_t>(axis)];
            p[axis] += static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(way)});
        }
        return p;
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
    static constexpr std::size_t kFirstWords = 6;
    static_assert(sizeof(CellPoint) == kFirstWords * sizeof(std::uint32_t));

    unsigned rootCellLog2_;
    bool wide_, colors_, normals_, errors_;
    std::size_t attributes_, words_;
};

}  // namespace iwalk
