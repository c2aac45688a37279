// The surface of a block of a x b x c cells, bent to a sphere by a formula that keeps areas alike: no
// triangle is much smaller than others, and three numbers come nearer to what is wanted than one. Vertices
// are numbered layer by layer; all is known in closed form.
#include "preprocess/generate/sphere.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "preprocess/generate/gradient_noise.hpp"
#include "preprocess/generate/random.hpp"

namespace iwalk {
namespace {

constexpr float kRadius = 10;                // model units
constexpr float kCoarsest = 1.7f;            // cells of the first octave of noise along the radius
constexpr float kRoughness = 0.16f;          // of the radius: strength of the first octave
constexpr float kDecay = 0.55f;              // of the strength, from octave to octave
constexpr std::uint32_t kCellsPerNoise = 8;  // of the surface in a cell of the finest octave

using Cells = std::array<std::uint32_t, 3>;  // along x, y, z

std::uint64_t trianglesOf(const Cells& cells) {
    const auto [a, b, c] = std::array<std::uint64_t, 3>{cells[0], cells[1], cells[2]};
    return 4 * (a * b + b * c + c * a);
}

// The block with the number of triangles next to the one wanted, among those that are nearly cubes.
Cells cellsFor(std::uint64_t triangles) {
    const auto middle = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(triangles) / 12));
    const std::uint64_t quarter = triangles / 4;
    Cells best{middle, middle, middle};
    const auto miss = [&](const Cells& cells) {
        return std::abs(static_cast<std::int64_t>(trianglesOf(cells)) - static_cast<std::int64_t>(triangles));
    };
    for (std::uint32_t a = middle - 3; a <= middle + 3; ++a) {
        for (std::uint32_t b = a; b <= middle + 3; ++b) {
            const std::uint64_t sum = std::uint64_t{a} + b;
            const auto c = static_cast<std::uint32_t>((quarter - std::uint64_t{a} * b + sum / 2) / sum);
            if (miss({a, b, c}) < miss(best)) best = {a, b, c};
        }
    }
    return best;
}

class Sphere {
  public:
    Sphere(const Cells& cells, std::uint64_t seed) : cells_(cells) {
        const std::uint32_t finest = *std::ranges::max_element(cells) / kCellsPerNoise;
        float frequency = kCoarsest, strength = kRoughness;
        for (std::uint64_t i = 0; i == 0 || frequency < static_cast<float>(finest); ++i) {
            octaves_.push_back({frequency, strength, static_cast<std::uint32_t>(seedOf(seed, i))});
            frequency *= 2.03f, strength *= kDecay;
        }
    }

    // Of the block's surface point (x, y, z), in cells.
    glm::vec3 position(const Cells& at) const {
        std::array<double, 3> p{}, squares{};
        for (std::size_t i = 0; i < 3; ++i) {
            p[i] = 2 * static_cast<double>(at[i]) / cells_[i] - 1;
            squares[i] = p[i] * p[i];
        }
        glm::vec3 direction;
        for (std::size_t i = 0; i < 3; ++i) {
            const double u = squares[(i + 1) % 3], v = squares[(i + 2) % 3];
            direction[i] = static_cast<float>(p[i] * std::sqrt(1 - u / 2 - v / 2 + u * v / 3));
        }
        return direction * (kRadius * (1 + height(direction)));
    }

    // The vertex at the block's surface point (x, y, z).
    std::uint32_t vertex(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
        const auto [a, b, c] = cells_;
        const std::uint32_t lid = (a + 1) * (b + 1), ring = 2 * (a + b);
        if (z == 0) return y * (a + 1) + x;
        if (z == c) return lid + (c - 1) * ring + y * (a + 1) + x;
        return lid + (z - 1) * ring + onRing(x, y);
    }
    const Cells& cells() const { return cells_; }

  private:
    struct Octave {
        float frequency, strength;
        std::uint32_t seed;
    };
    // A layer's ring, in the order in which rows along x meet it.
    std::uint32_t onRing(std::uint32_t x, std::uint32_t y) const {
        const auto [a, b, c] = cells_;
        if (y == 0) return x;
        if (y == b) return a + 1 + 2 * (b - 1) + x;
        return a + 1 + 2 * (y - 1) + (x == 0 ? 0 : 1);
    }
    float height(const glm::vec3& direction) const {
        float sum = 0;
        for (const Octave& octave : octaves_) {
            sum += octave.strength * gradientNoise(direction * octave.frequency, octave.seed);
        }
        return sum;
    }

    Cells cells_;
    std::vector<Octave> octaves_;
};

Result<void> writeVertices(const Sphere& sphere, PlyOutput& output, Progress& progress) {
    const auto [a, b, c] = sphere.cells();
    for (std::uint32_t z = 0; z <= c; ++z) {
        for (std::uint32_t y = 0; y <= b; ++y) {
            const bool full = z == 0 || z == c || y == 0 || y == b;
            for (std::uint32_t x = 0; x <= a; x += full ? 1 : a) output.vertex(sphere.position({x, y, z}));
        }
        RETURN_IF_ERROR(output.status());
        progress.done(static_cast<double>(z) / c);
    }
    return {};
}

using Quad = std::array<std::uint32_t, 4>;  // vertices, counter-clockwise seen from outside

void split(const Quad& quad, PlyOutput& output) {
    output.triangle(quad[0], quad[1], quad[2]);
    output.triangle(quad[0], quad[2], quad[3]);
}

void writeLids(const Sphere& sphere, PlyOutput& output) {
    const auto [a, b, c] = sphere.cells();
    const std::uint32_t top = c;
    for (std::uint32_t y = 0; y < b; ++y) {
        for (std::uint32_t x = 0; x < a; ++x) {
            const auto at = [&](std::uint32_t dx, std::uint32_t dy, std::uint32_t z) {
                return sphere.vertex(x + dx, y + dy, z);
            };
            split({at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0)}, output);
            split({at(0, 0, top), at(1, 0, top), at(1, 1, top), at(0, 1, top)}, output);
        }
    }
}

// The four sides between layers z and z + 1.
void writeSides(const Sphere& sphere, std::uint32_t z, PlyOutput& output) {
    const auto [a, b, c] = sphere.cells();
    const auto side = [&](std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
        split({sphere.vertex(x0, y0, z), sphere.vertex(x1, y1, z), sphere.vertex(x1, y1, z + 1),
               sphere.vertex(x0, y0, z + 1)},
              output);
    };
    for (std::uint32_t x = 0; x < a; ++x) side(x, 0, x + 1, 0), side(x + 1, b, x, b);
    for (std::uint32_t y = 0; y < b; ++y) side(0, y + 1, 0, y), side(a, y, a, y + 1);
}

}  // namespace

Result<void> generateSphere(std::uint64_t triangles, std::uint64_t seed, PlyOutput& output,
                            Progress& progress) {
    const Sphere sphere(cellsFor(triangles), seed);
    progress.phase("vertices");
    RETURN_IF_ERROR(writeVertices(sphere, output, progress));
    progress.phase("triangles");
    writeLids(sphere, output);
    for (std::uint32_t z = 0; z < sphere.cells()[2]; ++z) {
        writeSides(sphere, z, output);
        RETURN_IF_ERROR(output.status());
        progress.done(static_cast<double>(z) / sphere.cells()[2]);
    }
    return {};
}

}  // namespace iwalk
