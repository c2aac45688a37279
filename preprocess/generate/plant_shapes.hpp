#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include "preprocess/generate/part_writer.hpp"

namespace iwalk {

// Simple parts, all of them closed surfaces. Lengths in metres.

struct Direction {
    int axis = 2;  // 0 x, 1 y, 2 z
    int sign = 1;
    glm::dvec3 vector() const;
};

// The rings of a sweep along `direction` have these axes.
Ring ringAt(const glm::dvec3& center, const Direction& direction, double scale = 1);

// A circle of radius 1 with 3 to 64 corners; a square of side 1 around 0.
const Profile& circle(std::uint32_t sides);
const Profile& square();
// As many corners as a round part of this radius has.
std::uint32_t sidesFor(double radius);

void addBox(PartWriter& writer, const glm::dvec3& low, const glm::dvec3& high, Rgb color);
// A beam with an I section, its web upright, `height` high, around the line between two points.
void addBeam(PartWriter& writer, const glm::dvec3& from, const glm::dvec3& to, double height, Rgb color);
// A cylinder of `length` from `base` on.
void addCylinder(PartWriter& writer, const glm::dvec3& base, const Direction& direction, double length,
                 double radius, std::uint32_t sides, Rgb color);

struct Station {
    double along = 0, radius = 0;
};
// A body of revolution: round sections along `direction`.
void addRevolved(PartWriter& writer, const glm::dvec3& base, const Direction& direction,
                 std::span<const Station> stations, std::uint32_t sides, Rgb color);
// A ring around `direction`, like a hand wheel's rim.
void addTorus(PartWriter& writer, const glm::dvec3& center, const Direction& direction, double radius,
              double thickness, Rgb color);
// A tube through points of which two that follow one another differ in one coordinate, with rounded bends.
// `radius` is the tube's, `bend` the bends'.
void addTube(PartWriter& writer, std::span<const glm::dvec3> points, double radius, double bend,
             std::uint32_t sides, Rgb color);

}  // namespace iwalk
