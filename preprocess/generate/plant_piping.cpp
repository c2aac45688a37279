#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "preprocess/generate/plant_bay.hpp"
#include "preprocess/generate/plant_fittings.hpp"

namespace iwalk {
namespace {

// What flows in a pipe shows in its colour (as in DIN 2403).
constexpr std::array<Rgb, 8> kMedia{{{52, 126, 70},      // water
                                     {188, 190, 192},    // steam, insulated
                                     {214, 178, 44},     // gas
                                     {70, 110, 168},     // air
                                     {176, 52, 44},      // fire water
                                     {126, 84, 52},      // oil
                                     {206, 120, 44},     // acid
                                     {112, 116, 120}}};  // bare steel
constexpr Rgb kTray{172, 178, 184};
constexpr std::array<Rgb, 5> kCables{
    {{34, 34, 36}, {196, 96, 30}, {44, 70, 140}, {120, 122, 124}, {50, 100, 60}}};
constexpr double kBendPerRadius = 3;
constexpr Direction kUp{2, 1};

Direction directionOf(const glm::dvec3& from, const glm::dvec3& to) {
    for (int axis = 0; axis < 3; ++axis) {
        const double step = to[static_cast<std::size_t>(axis)] - from[static_cast<std::size_t>(axis)];
        if (step > 0) return {axis, 1};
        if (step < 0) return {axis, -1};
    }
    return {};
}

// A coordinate in the bay at least `least` away from `from`, on lanes of 15 cm.
double lane(Random& random, double from, double least, double low, double high) {
    double to = from;
    for (int i = 0; i < 16 && std::max(to - from, from - to) < least; ++i) {
        to = low + 0.15 * random.below(static_cast<std::uint32_t>((high - low) / 0.15) + 1);
    }
    return std::max(to - from, from - to) >= least ? to : (from - low > high - from ? low : high);
}

// In a quarter of the bay, beside the aisles.
double besideAisle(Random& random) {
    const double at = random.between(0.4, kAisleLow - 0.3);
    return random.chance(0.5) ? at : kBaySide - at;
}

// Up and down and to and fro under the ceiling; every second one comes from a machine or goes to one, and
// every fifth stands upright through the floor.
std::vector<glm::dvec3> route(const Bay& bay, double radius, Random& random) {
    const double least = 2 * kBendPerRadius * radius + 0.25;
    std::vector<glm::dvec3> points;
    glm::dvec3 at{besideAisle(random), besideAisle(random), random.between(0.2, 1.2)};
    const std::uint32_t kind = random.below(5);
    if (kind == 0) at.z = 0;
    if (kind < 3) points.push_back(bay.origin() + at);
    at.z = std::max(at.z + least, kAisleHeight + 0.2 + 0.15 * random.below(10));
    points.push_back(bay.origin() + at);
    std::size_t axis = random.below(2);
    for (std::uint32_t i = 2 + random.below(4); i > 0; --i) {
        at[axis] = axis == 2 ? lane(random, at.z, least, kAisleHeight + 0.2, 4.3)
                             : lane(random, at[axis], least, 0.3, kBaySide - 0.3);
        points.push_back(bay.origin() + at);
        const bool rises = axis != 2 && radius < 0.09 && random.chance(0.3);
        axis = rises ? 2 : (axis == 2 ? random.below(2) : 1 - axis);
    }
    return points;
}

double pipeRadius(Random& random) {
    constexpr std::array<double, 8> kRadii{0.02, 0.027, 0.035, 0.045, 0.057, 0.084, 0.11, 0.14};
    return kRadii[std::min(random.below(8), random.below(8))];
}

// Flanges, valves and clamps on the straight parts.
void addFittings(PartWriter& writer, std::span<const glm::dvec3> points, double radius, Rgb color,
                 Random& random) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Direction direction = directionOf(points[i], points[i + 1]);
        const double length = glm::length(points[i + 1] - points[i]), bend = kBendPerRadius * radius;
        const double straight = length - 2 * bend, middle = length * 0.5;
        const glm::dvec3 along = direction.vector();
        if (straight > 6 * radius + 0.3 && random.chance(0.3)) {
            const Direction stem =
                direction.axis == 2 ? Direction{static_cast<int>(random.below(2)), 1} : Direction{2, 1};
            addValve(writer, points[i] + along * middle, direction, stem, radius, color);
        } else if (random.chance(0.6)) {
            addFlange(writer, points[i] + along * middle, direction, radius, color);
        }
        for (double at = bend + 0.3; at < length - bend; at += 1.5) {
            addClamp(writer, points[i] + along * at, direction, radius);
        }
    }
}

// Along x (axis 0) or y (axis 1) through the whole bay.
void addMain(PartWriter& writer, const Bay& bay, std::size_t axis, double across, double z, double radius,
             Rgb color) {
    const Direction direction{static_cast<int>(axis), 1};
    glm::dvec3 start(0, 0, z);
    start[1 - axis] = across;
    start += bay.origin();
    addCylinder(writer, start, direction, kBaySide, radius, sidesFor(radius), color);
    addFlange(writer, start + direction.vector() * 0.8, direction, radius, color);
    addFlange(writer, start + direction.vector() * 6.8, direction, radius, color);
    for (const double at : {2.0, 4.0, 6.0}) {
        addClamp(writer, start + direction.vector() * at, direction, radius);
    }
}

// A ladder tray with cables that sag and cross a little.
void addTray(PartWriter& writer, const Bay& bay, double y, double z, Random& random) {
    constexpr double kHalf = 0.22, kRail = 0.06;
    for (const double side : {-kHalf, kHalf}) {
        addBox(writer, bay.at(0, y + side - 0.01, z), bay.at(kBaySide, y + side + 0.01, z + kRail), kTray);
    }
    for (double x = 0.1; x < kBaySide; x += 0.25) {
        addBox(writer, bay.at(x - 0.015, y - kHalf, z), bay.at(x + 0.015, y + kHalf, z + 0.015), kTray);
    }
    for (int i = 0; i < 9; ++i) {
        const double radius = random.between(0.008, 0.02);
        const Rgb color = kCables[random.below(kCables.size())];
        std::vector<Ring> rings;
        const double middle = -kHalf + 0.05 + 0.042 * i;
        for (int step = 0; step <= 24; ++step) {
            const double end = step == 0 || step == 24 ? 0 : 1;
            const double dy = end * random.between(-0.015, 0.015), dz = end * random.between(0, 0.02);
            const glm::dvec3 at = bay.at(kBaySide * step / 24, y + middle + dy, z + 0.017 + radius + dz);
            rings.push_back(ringAt(at, Direction{0, 1}, radius));
        }
        writer.sweep(circle(8), rings, color);
    }
}

}  // namespace

void addMains(PartWriter& writer, const Bay& bay) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
        // The same for all bays in a row, so that pipes go on.
        Random random(seedOf(bay.seed, 10 + axis, axis == 0 ? bay.y : bay.x, bay.storey));
        double across = random.between(0.4, 0.7);
        const double z = axis == 0 ? 4.05 : 3.65;
        while (across < kBaySide - 0.4 && bay.left(writer) > 4000) {
            const double radius = pipeRadius(random);
            const Rgb color = kMedia[random.below(kMedia.size())];
            addMain(writer, bay, axis, across + radius, z, radius, color);
            across += 2 * radius + random.between(0.12, random.chance(0.2) ? 1.6 : 0.3);
        }
    }
    Random random(seedOf(bay.seed, 12, bay.x + 4096 * std::uint64_t{bay.y}, bay.storey));
    for (const double y : {1.2, 2.8, 5.2, 6.8}) {
        if (bay.left(writer) > 30'000) addTray(writer, bay, y, 3.35, random);
    }
}

void addPipe(PartWriter& writer, const Bay& bay, Random& random) {
    const double radius = pipeRadius(random);
    const Rgb color = kMedia[random.below(kMedia.size())];
    const std::vector<glm::dvec3> points = route(bay, radius, random);
    addTube(writer, points, radius, kBendPerRadius * radius, sidesFor(radius), color);
    addFittings(writer, points, radius, color, random);
    addFlange(writer, points.front(), directionOf(points[0], points[1]), radius, color);
    addFlange(writer, points.back(), directionOf(points[points.size() - 2], points.back()), radius, color);
}

void addRiser(PartWriter& writer, const Bay& bay, Random& random) {
    const double radius = pipeRadius(random) * 0.6;
    const double x = random.chance(0.5) ? 0.25 : kBaySide - 0.25, y = besideAisle(random);
    const glm::dvec3 base = bay.at(x, y, 0);
    addCylinder(writer, base, kUp, kStoreyHeight - 0.25, radius, sidesFor(radius),
                kMedia[random.below(kMedia.size())]);
    addFlange(writer, base + glm::dvec3(0, 0, random.between(0.8, 2)), kUp, radius, kMedia.back());
    for (double z = 0.4; z < 4.5; z += 1.3) addClamp(writer, base + glm::dvec3(0, 0, z), kUp, radius);
}

void addConduit(PartWriter& writer, const Bay& bay, Random& random) {
    const double x = random.chance(0.5) ? 0.13 : kBaySide - 0.13, y = besideAisle(random);
    const double radius = random.between(0.008, 0.016);
    addCylinder(writer, bay.at(x, y, 0), kUp, kStoreyHeight - 0.25, radius, 8, kTray);
}

void addPlate(PartWriter& writer, const Bay& bay, Random& random) {
    const double x = besideAisle(random), y = besideAisle(random);
    const glm::dvec3 at = bay.at(x, y, 0);
    const double size = random.between(0.06, 0.16);
    addBox(writer, at, at + glm::dvec3(size, size, 0.02), kTray);
}

}  // namespace iwalk
