#include "preprocess/generate/plant_fittings.hpp"

#include <algorithm>
#include <array>

#include "preprocess/generate/trigonometry.hpp"

namespace iwalk {
namespace {

constexpr Rgb kBolt{90, 90, 94}, kWheel{190, 36, 30}, kStem{200, 200, 196}, kClampColor{110, 114, 118};

double flangeThickness(double radius) {
    return 0.012 + 0.12 * radius;
}

}  // namespace

void addFlange(PartWriter& writer, const glm::dvec3& at, const Direction& direction, double radius,
               Rgb color) {
    const double thick = flangeThickness(radius), wide = radius * 1.55 + 0.012, gap = 0.003;
    const std::uint32_t sides = sidesFor(radius);
    const glm::dvec3 along = direction.vector();
    addCylinder(writer, at - along * (thick + gap), direction, thick, wide, sides, color);
    addCylinder(writer, at + along * gap, direction, thick, wide, sides, color);
    const std::uint32_t bolts = radius < 0.06 ? 4 : (radius < 0.15 ? 8 : 12);
    const double circleRadius = (radius + wide) / 2, reach = thick * 1.5 + gap;
    const Ring plane = ringAt(at, direction);
    for (std::uint32_t i = 0; i < bolts; ++i) {
        const glm::dvec2 p = onCircle((i + 0.5) / bolts) * circleRadius;
        const glm::dvec3 base = at + plane.u * p.x + plane.v * p.y - along * reach;
        addCylinder(writer, base, direction, 2 * reach, 0.006 + 0.06 * radius, 6, kBolt);
    }
}

void addValve(PartWriter& writer, const glm::dvec3& at, const Direction& direction, const Direction& stem,
              double radius, Rgb color) {
    const double half = 2.2 * radius + 0.03;
    const glm::dvec3 along = direction.vector(), up = stem.vector();
    const std::array<Station, 7> body{{{0, radius * 1.2},
                                       {half * 0.4, radius * 1.25},
                                       {half * 0.7, radius * 1.7},
                                       {half, radius * 1.85},
                                       {half * 1.3, radius * 1.7},
                                       {half * 1.6, radius * 1.25},
                                       {half * 2, radius * 1.2}}};
    addRevolved(writer, at - along * half, direction, body, sidesFor(radius), color);
    addFlange(writer, at - along * half, direction, radius, color);
    addFlange(writer, at + along * half, direction, radius, color);
    const double height = 4.2 * radius + 0.08, wheel = 1.5 * radius + 0.04;
    addCylinder(writer, at, stem, height * 0.6, radius * 0.8, 16, color);
    addCylinder(writer, at, stem, height * 1.05, radius * 0.15 + 0.006, 10, kStem);
    addTorus(writer, at + up * height, stem, wheel, 0.008 + 0.08 * radius, kWheel);
    for (const int axis : {(stem.axis + 1) % 3, (stem.axis + 2) % 3}) {  // the wheel's spokes
        const Direction spoke{axis, 1};
        addCylinder(writer, at + up * height - spoke.vector() * wheel, spoke, 2 * wheel,
                    0.005 + 0.05 * radius, 6, kWheel);
    }
}

void addClamp(PartWriter& writer, const glm::dvec3& at, const Direction& direction, double radius) {
    const double width = 0.04;
    addCylinder(writer, at - direction.vector() * (width / 2), direction, width, radius * 1.08 + 0.004,
                sidesFor(radius), kClampColor);
}

}  // namespace iwalk
