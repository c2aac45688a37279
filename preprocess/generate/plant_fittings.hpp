#pragma once

#include "preprocess/generate/plant_shapes.hpp"

namespace iwalk {

// What sits on pipes. `at` is on the pipe's axis, which has this direction; `radius` is the pipe's. Metres.

// Two flanges with their bolts.
void addFlange(PartWriter& writer, const glm::dvec3& at, const Direction& direction, double radius,
               Rgb color);
// A valve with flanges on both sides and a hand wheel, whose stem has another direction.
void addValve(PartWriter& writer, const glm::dvec3& at, const Direction& direction, const Direction& stem,
              double radius, Rgb color);
// A clamp around the pipe.
void addClamp(PartWriter& writer, const glm::dvec3& at, const Direction& direction, double radius);

}  // namespace iwalk
