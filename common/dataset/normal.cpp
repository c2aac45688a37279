// Octahedral unit vectors: Cigolle et al., A Survey of Efficient Representations for Independent Unit
// Vectors, JCGT 2014, plain rounding (their oct32: at most 0.004 degrees off).
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "common/dataset/page.hpp"

namespace iwalk {
namespace {

constexpr float kSnormScale = 32767.0f;

std::uint32_t toSnorm(float value) {
    const float scaled = std::round(std::clamp(value, -1.0f, 1.0f) * kSnormScale);
    return static_cast<std::uint16_t>(static_cast<std::int16_t>(scaled));
}

float fromSnorm(std::uint32_t bits) {
    return std::max(static_cast<float>(static_cast<std::int16_t>(bits & 0xffffu)) / kSnormScale, -1.0f);
}

}  // namespace

std::uint32_t packNormal(const glm::vec3& unit) {
    const float sum = std::abs(unit.x) + std::abs(unit.y) + std::abs(unit.z);
    if (!(sum > 0)) return 0;  // no direction: +z
    const float x = unit.x / sum, y = unit.y / sum;
    if (unit.z >= 0) return toSnorm(x) | toSnorm(y) << 16;
    const float foldedX = std::copysign(1 - std::abs(y), x), foldedY = std::copysign(1 - std::abs(x), y);
    return toSnorm(foldedX) | toSnorm(foldedY) << 16;
}

glm::vec3 unpackNormal(std::uint32_t packed) {
    glm::vec3 normal(fromSnorm(packed), fromSnorm(packed >> 16), 0);
    normal.z = 1 - std::abs(normal.x) - std::abs(normal.y);
    const float below = std::max(-normal.z, 0.0f);
    normal.x -= std::copysign(below, normal.x);
    normal.y -= std::copysign(below, normal.y);
    return glm::normalize(normal);
}

}  // namespace iwalk
