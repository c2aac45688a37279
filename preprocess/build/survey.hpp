#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "preprocess/build/lattice.hpp"
#include "preprocess/import/importer.hpp"

namespace iwalk {

// Some thousands of positions, evenly over all that were added, the same for the same sequence: every k-th is
// kept, and k doubles whenever there are too many.
class Sample {
  public:
    void add(std::span<const glm::dvec3> positions);
    const std::vector<glm::dvec3>& positions() const { return positions_; }

  private:
    std::vector<glm::dvec3> positions_;
    std::uint64_t every_ = 1, seen_ = 0;
};

// How far vertices are from the origin: how many have their largest |coordinate| in which power of two.
class Distances {
  public:
    void add(std::span<const glm::dvec3> positions);
    // How many binary digits more of a fraction the coordinates of nearly all vertices (19 of 20) have than
    // the largest one has, if that is a stray, 8 digits or more beyond them; otherwise 0.
    int spareDigits() const;

  private:
    std::array<std::uint64_t, 2048> counts_{};  // by the exponent's bits
};

// Where the middle of the model is, strays apart; lattice.
LatticePoint middleOf(const Sample& sample, int stepExponent);

// The box of the inputs on a lattice; empty when they have no vertices.
LatticeBox boundsOnLattice(std::span<const ImportSummary> inputs, int stepExponent);

// The lattice for inputs that were scanned. The step is 2^(ceil(log2 R) - 24), where R is the largest side of
// the box around the middle 90 % of the sample: 24 bits across the model, and one stray vertex does not make
// it coarse. It is never finer than the finest input's own precision, rounded up to a power of two: that
// would only cost bits. It must not follow from the first bounds alone, since it stays for good: models
// inserted later share the lattice. Fails when `stepExponent` is given and does not suit.
Result<Lattice> chooseLattice(std::span<const ImportSummary> inputs, const Sample& sample,
                              std::optional<int> stepExponent);

}  // namespace iwalk
