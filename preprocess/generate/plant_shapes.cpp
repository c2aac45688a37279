#include "preprocess/generate/plant_shapes.hpp"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "common/check.hpp"
#include "preprocess/generate/trigonometry.hpp"

namespace iwalk {
namespace {

constexpr std::uint32_t kMostSides = 64;

Profile makeCircle(std::uint32_t sides) {
    Profile profile;
    for (std::uint32_t i = 0; i < sides; ++i)
        profile.points.push_back(onCircle(static_cast<double>(i) / sides));
    for (std::uint32_t i = 2; i < sides; ++i) profile.cap.push_back({0, i - 1, i});
    return profile;
}

// Height 1, width 0.5, around 0; v is up.
Profile makeSectionI() {
    constexpr double kWeb = 0.03, kFlange = 0.44, kHalf = 0.5, kWidth = 0.25;
    return {{{-kWidth, -kHalf},
             {kWidth, -kHalf},
             {kWidth, -kFlange},
             {kWeb, -kFlange},
             {kWeb, kFlange},
             {kWidth, kFlange},
             {kWidth, kHalf},
             {-kWidth, kHalf},
             {-kWidth, kFlange},
             {-kWeb, kFlange},
             {-kWeb, -kFlange},
             {-kWidth, -kFlange}},
            {{0, 1, 2},
             {0, 2, 3},
             {0, 3, 10},
             {0, 10, 11},
             {3, 4, 10},
             {4, 9, 10},
             {4, 5, 6},
             {4, 6, 7},
             {4, 7, 9},
             {7, 8, 9}}};
}

glm::dvec3 unit(int axis) {
    glm::dvec3 vector(0);
    vector[static_cast<std::size_t>(axis)] = 1;
    return vector;
}

// Turns a vector by the angle with this cosine and sine, about a unit axis to which it need not be normal.
glm::dvec3 turned(const glm::dvec3& vector, const glm::dvec3& axis, const glm::dvec2& angle) {
    const glm::dvec3 along = axis * glm::dot(axis, vector), across = vector - along;
    return along + across * angle.x + glm::cross(axis, across) * angle.y;
}

// The rings of a quarter bend around a corner, from direction `from` to direction `to`, both unit vectors.
// `ring` has the axes before the bend, and after it.
void addBend(std::vector<Ring>& rings, Ring& ring, const glm::dvec3& corner, const glm::dvec3& from,
             const glm::dvec3& to, double bend, std::uint32_t steps) {
    const glm::dvec3 axis = glm::cross(from, to), pivot = corner + (to - from) * bend;
    const Ring before = ring;
    for (std::uint32_t i = 0; i <= steps; ++i) {
        const glm::dvec2 angle = onCircle(0.25 * i / steps);
        ring = {pivot + turned(to * -bend, axis, angle), turned(before.u, axis, angle),
                turned(before.v, axis, angle)};
        rings.push_back(ring);
    }
}

}  // namespace

glm::dvec3 Direction::vector() const {
    return unit(axis) * static_cast<double>(sign);
}

Ring ringAt(const glm::dvec3& center, const Direction& direction, double scale) {
    const glm::dvec3 u = unit((direction.axis + 1) % 3), v = unit((direction.axis + 2) % 3);
    return direction.sign > 0 ? Ring{center, u * scale, v * scale} : Ring{center, v * scale, u * scale};
}

const Profile& circle(std::uint32_t sides) {
    static const std::vector<Profile> kCircles = [] {
        std::vector<Profile> circles(3);
        for (std::uint32_t i = 3; i <= kMostSides; ++i) circles.push_back(makeCircle(i));
        return circles;
    }();
    CHECK_OP(sides, >=, 3u);
    return kCircles[std::min(sides, kMostSides)];
}

const Profile& square() {
    static const Profile kSquare{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}},
                                 {{0, 1, 2}, {0, 2, 3}}};
    return kSquare;
}

std::uint32_t sidesFor(double radius) {
    constexpr std::array<std::pair<double, std::uint32_t>, 6> kSides{
        {{0.012, 8}, {0.03, 12}, {0.07, 16}, {0.15, 20}, {0.3, 24}, {0.6, 32}}};
    for (const auto& [most, sides] : kSides) {
        if (radius < most) return sides;
    }
    return 40;
}

void addBox(PartWriter& writer, const glm::dvec3& low, const glm::dvec3& high, Rgb color) {
    const glm::dvec3 size = high - low, middle = (low + high) * 0.5;
    const glm::dvec3 u{size.x, 0, 0}, v{0, size.y, 0};
    const std::array<Ring, 2> rings{Ring{{middle.x, middle.y, low.z}, u, v},
                                    Ring{{middle.x, middle.y, high.z}, u, v}};
    writer.sweep(square(), rings, color);
}

void addBeam(PartWriter& writer, const glm::dvec3& from, const glm::dvec3& to, double height, Rgb color) {
    static const Profile kSection = makeSectionI();
    const glm::dvec3 along = glm::normalize(to - from);
    const glm::dvec3 up = along.z * along.z > 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 u = glm::cross(up, along) * height, v = up * height;
    const std::array<Ring, 2> rings{Ring{from, u, v}, Ring{to, u, v}};
    writer.sweep(kSection, rings, color);
}

void addCylinder(PartWriter& writer, const glm::dvec3& base, const Direction& direction, double length,
                 double radius, std::uint32_t sides, Rgb color) {
    const std::array<Station, 2> stations{Station{0, radius}, Station{length, radius}};
    addRevolved(writer, base, direction, stations, sides, color);
}

void addRevolved(PartWriter& writer, const glm::dvec3& base, const Direction& direction,
                 std::span<const Station> stations, std::uint32_t sides, Rgb color) {
    std::vector<Ring> rings;
    for (const Station& station : stations) {
        rings.push_back(ringAt(base + direction.vector() * station.along, direction, station.radius));
    }
    writer.sweep(circle(sides), rings, color);
}

void addTorus(PartWriter& writer, const glm::dvec3& center, const Direction& direction, double radius,
              double thickness, Rgb color) {
    constexpr std::uint32_t kSteps = 20, kSides = 6;
    const Ring plane = ringAt(center, direction);
    const glm::dvec3 axis = direction.vector();
    std::vector<Ring> rings;
    for (std::uint32_t i = 0; i < kSteps; ++i) {
        const glm::dvec2 at = onCircle(static_cast<double>(i) / kSteps);
        const glm::dvec3 out = plane.u * at.x + plane.v * at.y;
        rings.push_back({center + out * radius, axis * thickness, out * thickness});
    }
    writer.sweepAround(circle(kSides), rings, color);
}

void addTube(PartWriter& writer, std::span<const glm::dvec3> points, double radius, double bend,
             std::uint32_t sides, Rgb color) {
    const auto direction = [&](std::size_t i) { return glm::normalize(points[i + 1] - points[i]); };
    const glm::dvec3 start = direction(0);
    const glm::dvec3 u = start.z * start.z > 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
    Ring ring{points[0], u * radius, glm::cross(start, u) * radius};
    std::vector<Ring> rings{ring};
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        addBend(rings, ring, points[i], direction(i - 1), direction(i), bend, std::max(4u, sides / 2));
    }
    ring.center = points.back();
    rings.push_back(ring);
    writer.sweep(circle(sides), rings, color);
}

}  // namespace iwalk
