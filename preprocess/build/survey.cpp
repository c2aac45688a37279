#include "preprocess/build/survey.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace iwalk {
namespace {

constexpr std::size_t kSampleSize = 16384;
constexpr int kBitsAcross = 24;
constexpr int kMaxExponent = 1000;
constexpr int kStrayDigits = 8;

// The largest side of the box that leaves out the lowest and highest twentieth in each axis.
double middleSide(const std::vector<glm::dvec3>& positions) {
    double side = 0;
    std::vector<double> values(positions.size());
    for (std::size_t axis = 0; axis < 3 && !positions.empty(); ++axis) {
        std::ranges::transform(positions, values.begin(), [&](const glm::dvec3& p) { return p[axis]; });
        std::ranges::sort(values);
        const std::size_t cut = values.size() / 20;
        side = std::max(side, values[values.size() - 1 - cut] - values[cut]);
    }
    return side;
}

// The smallest e with 2^e >= value; value > 0.
int ceilLog2(double value) {
    int exponent = 0;
    const double mantissa = std::frexp(std::min(value, std::numeric_limits<double>::max()), &exponent);
    return mantissa > 0.5 ? exponent : exponent - 1;
}

int chooseStep(std::span<const ImportSummary> inputs, const Sample& sample, const ModelBox& bounds) {
    double side = middleSide(sample.positions());
    if (!(side > 0)) side = bounds.edge();
    if (!(side > 0)) side = 1;
    double precision = 0;  // the finest that is known
    for (const ImportSummary& input : inputs) {
        if (input.precision > 0 && (precision == 0 || input.precision < precision))
            precision = input.precision;
    }
    int exponent = ceilLog2(side) - kBitsAcross;
    if (precision > 0) exponent = std::max(exponent, ceilLog2(precision));
    return std::clamp(exponent, -kMaxExponent, kMaxExponent);
}

// In steps; what lies out of reach is cut off here, and refused when a triangle has it as a corner.
std::int64_t toLattice(double value, int stepExponent) {
    const double limit = static_cast<double>(kMaxSteps);
    return static_cast<std::int64_t>(
        std::nearbyint(std::clamp(std::ldexp(value, -stepExponent), -limit, limit)));
}

}  // namespace

void Sample::add(std::span<const glm::dvec3> positions) {
    const std::uint64_t skip = (every_ - seen_ % every_) % every_;
    for (std::uint64_t i = skip; i < positions.size(); i += every_) {
        positions_.push_back(positions[i]);
        if (positions_.size() < kSampleSize) continue;
        // Keep those whose number in the whole sequence is a multiple of the new k.
        for (std::size_t kept = 0; kept < kSampleSize / 2; ++kept) positions_[kept] = positions_[2 * kept];
        positions_.resize(kSampleSize / 2);
        // The one just added was an odd multiple of the old k, so the next of interest is one old k away.
        i -= every_;
        every_ *= 2;
    }
    seen_ += positions.size();
}

void Distances::add(std::span<const glm::dvec3> positions) {
    for (const glm::dvec3& p : positions) {
        const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        ++counts_[std::bit_cast<std::uint64_t>(largest) >> 52];
    }
}

int Distances::spareDigits() const {
    const std::uint64_t few = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0}) / 20;
    std::size_t largest = counts_.size() - 1;
    while (largest > 0 && counts_[largest] == 0) --largest;
    std::size_t at = largest;
    for (std::uint64_t beyond = 0; at > 0 && beyond + counts_[at] <= few;) beyond += counts_[at--];
    const int digits = static_cast<int>(largest - at);
    return digits < kStrayDigits ? 0 : digits;
}

LatticePoint middleOf(const Sample& sample, int stepExponent) {
    LatticePoint middle(0);
    std::vector<double> values(sample.positions().size());
    for (glm::length_t axis = 0; axis < 3 && !values.empty(); ++axis) {
        std::ranges::transform(sample.positions(), values.begin(),
                               [axis](const glm::dvec3& p) { return p[axis]; });
        const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::ranges::nth_element(values, half);
        middle[axis] = toLattice(*half, stepExponent);
    }
    return middle;
}

LatticeBox boundsOnLattice(std::span<const ImportSummary> inputs, int stepExponent) {
    LatticeBox box;
    for (const ImportSummary& input : inputs) {
        if (input.bounds.empty()) continue;
        for (const glm::dvec3& corner : {input.bounds.min, input.bounds.max}) {
            box.add(LatticePoint(toLattice(corner.x, stepExponent), toLattice(corner.y, stepExponent),
                                 toLattice(corner.z, stepExponent)));
        }
    }
    return box;
}

Result<Lattice> chooseLattice(std::span<const ImportSummary> inputs, const Sample& sample,
                              std::optional<int> stepExponent) {
    ModelBox bounds;
    for (const ImportSummary& input : inputs) bounds.add(input.bounds);
    if (bounds.empty()) return fail("the inputs have no vertices: there is nothing to build");
    if (stepExponent && std::abs(*stepExponent) > kMaxExponent) {
        return fail("--step 2^{} is out of range: give an exponent from -{} to {}", *stepExponent,
                    kMaxExponent, kMaxExponent);
    }

    Lattice lattice;
    lattice.stepExponent = stepExponent ? *stepExponent : chooseStep(inputs, sample, bounds);
    const LatticeBox box = boundsOnLattice(inputs, lattice.stepExponent);
    lattice.rootCell = box.min;
    lattice.rootCellLog2 = static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(box.edge())));
    return lattice;
}

}  // namespace iwalk
