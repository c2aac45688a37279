#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace iwalk {

// Gradient noise at a point of space, about -1 to 1, 0 on average; it changes over distances of about 1.
float gradientNoise(const glm::vec3& at, std::uint32_t seed);

}  // namespace iwalk
