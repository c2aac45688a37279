#include "preprocess/generate/mixing_field.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "preprocess/generate/random.hpp"

namespace iwalk {
namespace {

constexpr double kCoarsest = 5;              // lattice cells of the first octave, along the layer's side
constexpr double kLacunarity = 2.03;         // not 2: lattices must not line up
constexpr double kFirst = 27, kSecond = 25;  // strengths of the first two octaves, model units
constexpr double kDecay = 0.9;               // of the strength, from octave to octave
constexpr double kFinest = 3.2;              // cells of the grid in a lattice cell of the finest octave
constexpr float kBillowMean = 0.15f;         // of |noise|
constexpr double kDeviation = 0.19;          // standard deviation of the noise
constexpr double kDeviations = 3.9;          // that are never exceeded, as good as
constexpr std::size_t kRun = 16;             // points that are done or left out together

// Takes an octave from the values of a run. False: all |values| are above `rest`.
template <bool billow>
bool take(const SplineOctave::Row& noise, std::size_t first, float strength, float rest, float* values) {
    Four least = fourOf(FLT_MAX);
    for (std::size_t i = first; i < first + kRun; i += 4) {
        const Four of = noise.at(i);
        const Four value = loadFour(values + i) - strength * (billow ? absolute(of) - kBillowMean : of);
        storeFour(values + i, value);
        least = lesser(least, absolute(value));
    }
    return anyAtMost(least, rest);
}

// The same for all runs that begin at `runs`. Those where that is false are left out from then on.
template <bool billow>
void takeAll(const SplineOctave::Row& noise, float strength, float rest, std::vector<std::size_t>& runs,
             float* values) {
    std::size_t* const data = runs.data();
    const std::size_t count = runs.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t first = data[i];
        const bool near = take<billow>(noise, first, strength, rest, values);
        data[kept] = first;
        kept += near ? 1 : 0;
    }
    runs.resize(kept);
}

}  // namespace

MixingField::MixingField(std::uint64_t seed, const IsosurfaceGrid& grid) : grid_(grid) {
    double strength = kSecond, cells = kCoarsest;
    const double most = grid.cells / kFinest;
    for (std::uint32_t i = 0; i == 0 || cells < most; ++i, cells *= kLacunarity) {
        if (i > 1) strength *= kDecay;
        // The last octave comes in gently as the grid becomes finer: no jump in the number of triangles.
        const double fade = i == 0 ? 1 : std::min(1.0, (most / cells - 1) / (kLacunarity - 1));
        const double full = (i == 0 ? kFirst : strength) * grid.amplitude * fade;
        const auto octaveSeed = static_cast<std::uint32_t>(seedOf(seed, i));
        octaves_.push_back({SplineOctave(octaveSeed, cells, grid), static_cast<float>(full), i > 0});
    }
    double squares = 0;
    for (std::size_t i = octaves_.size(); i-- > 0;) {
        octaves_[i].rest = static_cast<float>(kDeviations * kDeviation * std::sqrt(squares));
        squares += static_cast<double>(octaves_[i].strength) * static_cast<double>(octaves_[i].strength);
    }
}

void MixingField::slab(std::uint32_t x, std::span<float> values) {
    for (Octave& octave : octaves_) octave.noise.slab(x);
    for (std::uint32_t z = 0; z < grid_.rows(); ++z) row(z, &values[z * grid_.stride()]);
}

void MixingField::row(std::uint32_t z, float* values) {
    const double height = z * grid_.stepZ() - kLayerHalfHeight, relative = height / kLayerHalfHeight;
    const bool border = z == 0 || z == grid_.layers;
    const float envelope = border ? 0.0f : static_cast<float>(1 - relative * relative);
    std::fill_n(values, grid_.stride(), static_cast<float>(height));
    near_.clear();
    for (std::size_t first = 0; first < grid_.stride(); first += kRun) near_.push_back(first);
    for (Octave& octave : octaves_) {
        if (near_.empty()) return;
        const SplineOctave::Row noise = octave.noise.row(z);
        const float strength = octave.strength * envelope, rest = octave.rest * envelope;
        if (octave.billow) {
            takeAll<true>(noise, strength, rest, near_, values);
        } else {
            takeAll<false>(noise, strength, rest, near_, values);
        }
    }
}

}  // namespace iwalk
