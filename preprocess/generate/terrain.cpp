// Fractal noise whose octaves are the weaker the lower the land is that the ones before have made: rough
// mountains, smooth valleys (after Musgrave's multifractals; Ebert and others, Texturing and Modeling, ch.
// 16).
#include "preprocess/generate/terrain.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "preprocess/generate/gradient_noise.hpp"
#include "preprocess/generate/grid_surface.hpp"
#include "preprocess/generate/random.hpp"

namespace iwalk {
namespace {

constexpr double kSide = 16'000;             // metres
constexpr float kHeight = 2'600;             // metres, of the strongest octave
constexpr float kCoarsest = 3.1f;            // cells of the first octave along a side
constexpr float kDecay = 0.48f;              // of the strength, from octave to octave
constexpr float kSeaLevel = -120;            // metres against the noise's mean
constexpr std::uint32_t kCellsPerNoise = 4;  // of the grid in a cell of the finest octave

struct Tint {
    float above;  // metres
    Rgb color;
};
constexpr std::array<Tint, 7> kTints{{{-1e9f, {38, 84, 124}},
                                      {0.5f, {194, 178, 128}},
                                      {40, {96, 128, 56}},
                                      {350, {58, 96, 48}},
                                      {800, {112, 104, 88}},
                                      {1200, {136, 130, 124}},
                                      {1500, {240, 242, 245}}}};

class Land {
  public:
    Land(const CellGrid& grid, std::uint64_t seed) {
        const auto finest = static_cast<float>(std::max(grid.columns / kCellsPerNoise, 4u));
        for (float frequency = kCoarsest; octaves_.size() < 2 || frequency < finest; frequency *= 2.07f) {
            octaves_.push_back({frequency, static_cast<std::uint32_t>(seedOf(seed, octaves_.size()))});
        }
    }

    // At a place on the unit square.
    float height(float x, float y) const {
        float sum = 0, strength = 1, weight = 1;
        for (const Octave& octave : octaves_) {
            const glm::vec3 at(x * octave.frequency, y * octave.frequency, 0.37f);
            const float signal = strength * weight * gradientNoise(at, octave.seed);
            sum += signal;
            weight = std::clamp(0.35f + 1.3f * sum, 0.1f, 1.0f);
            strength *= kDecay;
        }
        return sum * kHeight - kSeaLevel;
    }

    // The limits between tints waver.
    Rgb color(float x, float y, float height) const {
        const glm::vec3 at(x * 60, y * 60, 0.71f);
        const float wavering =
            height > 0 ? height * (1 + 0.25f * gradientNoise(at, octaves_[0].seed)) : height;
        Rgb color = kTints[0].color;
        for (const Tint& tint : kTints) {
            if (wavering >= tint.above) color = tint.color;
        }
        return color;
    }

  private:
    struct Octave {
        float frequency;
        std::uint32_t seed;
    };
    std::vector<Octave> octaves_;
};

}  // namespace

Result<void> generateTerrain(std::uint64_t triangles, std::uint64_t seed, PlyOutput& output,
                             Progress& progress) {
    const CellGrid grid = CellGrid::ofTriangles(triangles);
    const Land land(grid, seed);
    RETURN_IF_ERROR(writeGridVertices(grid, output, progress, [&](std::uint32_t column, std::uint32_t row) {
        const double u = static_cast<double>(column) / grid.columns, v = static_cast<double>(row) / grid.rows;
        const auto x = static_cast<float>(u), y = static_cast<float>(v);
        const float height = land.height(x, y);
        output.vertex(
            glm::vec3(static_cast<float>(u * kSide), static_cast<float>(v * kSide), std::max(height, 0.0f)),
            land.color(x, y, height));
    }));
    return writeGridTriangles(grid, output, progress);
}

}  // namespace iwalk
