#pragma once

#include <glm/vec2.hpp>

namespace iwalk {

// (cos, sin) of an angle in turns. By polynomials, for libraries' functions differ between machines in their
// last bits; exact at multiples of a quarter turn, and to about 1e-15 elsewhere.
glm::dvec2 onCircle(double turns);

}  // namespace iwalk
