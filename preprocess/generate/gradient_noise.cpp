// Perlin, Improving Noise (SIGGRAPH 2002), with hashed instead of tabulated gradients.
#include "preprocess/generate/gradient_noise.hpp"

#include <array>

namespace iwalk {
namespace {

struct Axis {
    std::uint32_t cell = 0;
    float fraction = 0, weight = 0;  // the weight of the cell's far side
};

Axis split(float coordinate) {
    const auto whole = static_cast<std::int32_t>(coordinate);
    const std::int32_t cell = whole - (static_cast<float>(whole) > coordinate ? 1 : 0);
    const float t = coordinate - static_cast<float>(cell);
    return {static_cast<std::uint32_t>(cell), t, t * t * t * (t * (t * 6 - 15) + 10)};
}

// The directions to the edges of a cube, four of them twice.
struct Gradient {
    float x, y, z, padding;
};
constexpr std::array<Gradient, 16> kGradients{{{1, 1, 0, 0},
                                               {-1, 1, 0, 0},
                                               {1, -1, 0, 0},
                                               {-1, -1, 0, 0},
                                               {1, 0, 1, 0},
                                               {-1, 0, 1, 0},
                                               {1, 0, -1, 0},
                                               {-1, 0, -1, 0},
                                               {0, 1, 1, 0},
                                               {0, -1, 1, 0},
                                               {0, 1, -1, 0},
                                               {0, -1, -1, 0},
                                               {1, 1, 0, 0},
                                               {-1, 1, 0, 0},
                                               {0, -1, 1, 0},
                                               {0, -1, -1, 0}}};

float mix(float a, float b, float weight) {
    return a + weight * (b - a);
}

}  // namespace

float gradientNoise(const glm::vec3& at, std::uint32_t seed) {
    const Axis x = split(at.x), y = split(at.y), z = split(at.z);
    const std::array<std::uint32_t, 2> hashX{x.cell * 0x9e3779b9u ^ seed, (x.cell + 1) * 0x9e3779b9u ^ seed},
        hashY{y.cell * 0x85ebca77u, (y.cell + 1) * 0x85ebca77u},
        hashZ{z.cell * 0xc2b2ae3du, (z.cell + 1) * 0xc2b2ae3du};
    std::array<float, 8> corner{};
    for (std::uint32_t i = 0; i < 8; ++i) {
        const std::uint32_t dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
        std::uint32_t hash = hashX[dx] ^ hashY[dy] ^ hashZ[dz];
        hash = (hash ^ hash >> 15) * 0x2c1b3c6du;
        const Gradient& slope = kGradients[(hash ^ hash >> 12) >> 28];
        corner[i] = slope.x * (x.fraction - static_cast<float>(dx)) +
                    slope.y * (y.fraction - static_cast<float>(dy)) +
                    slope.z * (z.fraction - static_cast<float>(dz));
    }
    const float low = mix(mix(corner[0], corner[1], x.weight), mix(corner[2], corner[3], x.weight), y.weight);
    const float high =
        mix(mix(corner[4], corner[5], x.weight), mix(corner[6], corner[7], x.weight), y.weight);
    return mix(low, high, z.weight);
}

}  // namespace iwalk
