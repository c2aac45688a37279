#include <array>

#include "preprocess/generate/plant_bay.hpp"
#include "preprocess/generate/plant_fittings.hpp"
#include "preprocess/generate/trigonometry.hpp"

namespace iwalk {
namespace {

constexpr std::array<Rgb, 4> kTanks{{{196, 200, 204}, {164, 178, 190}, {214, 206, 186}, {110, 138, 160}}};
constexpr Rgb kLeg{80, 84, 88}, kMotor{38, 92, 150}, kPump{46, 112, 96}, kSkid{98, 100, 98},
    kCabinet{198, 200, 190}, kDark{52, 54, 58}, kLamp{220, 60, 40}, kGrating{128, 134, 138},
    kRail{226, 186, 40};
constexpr Direction kUp{2, 1};

// A vessel of this length over both domed ends.
void addVessel(PartWriter& writer, const glm::dvec3& base, const Direction& direction, double length,
               double radius, Rgb color) {
    constexpr int kSteps = 8;
    const double dome = radius * 0.5;  // its height
    std::array<Station, 2 * (kSteps + 1)> stations;
    for (std::size_t i = 0; i <= kSteps; ++i) {
        const glm::dvec2 at = onCircle(0.25 * (static_cast<double>(i) + 0.2) / (kSteps + 0.2));
        const double along = dome * (1 - at.x);
        stations[i] = {along, radius * at.y};
        stations[stations.size() - 1 - i] = {length - along, radius * at.y};
    }
    addRevolved(writer, base, direction, stations, sidesFor(radius), color);
}

// A short pipe that ends in a flange.
void addNozzle(PartWriter& writer, const glm::dvec3& from, const Direction& direction, double length,
               double radius, Rgb color) {
    addCylinder(writer, from, direction, length, radius, sidesFor(radius), color);
    addFlange(writer, from + direction.vector() * length, direction, radius, color);
}

void addTank(PartWriter& writer, const glm::dvec3& floor, Random& random) {
    const double radius = random.between(0.6, 0.95), length = random.between(1.8, 2.6), low = 0.45;
    const Rgb color = kTanks[random.below(kTanks.size())];
    addVessel(writer, floor + glm::dvec3(0, 0, low), kUp, length, radius, color);
    for (const glm::dvec2& leg :
         {glm::dvec2(1, 1), glm::dvec2(-1, 1), glm::dvec2(1, -1), glm::dvec2(-1, -1)}) {
        const glm::dvec2 at = leg * (radius * 0.66);
        addCylinder(writer, floor + glm::dvec3(at.x, at.y, 0), kUp, low + 0.4, 0.05, 12, kLeg);
        addCylinder(writer, floor + glm::dvec3(at.x, at.y, 0), kUp, 0.02, 0.12, 16, kLeg);
    }
    for (const double part : {0.3, 0.5, 0.7}) {  // stiffening rings
        addTorus(writer, floor + glm::dvec3(0, 0, low + length * part), kUp, radius, 0.025, color);
    }
    addNozzle(writer, floor + glm::dvec3(0, 0, low + length - 0.1), kUp, 0.35, 0.084, color);
    for (const int sign : {-1, 1}) {
        const Direction side{static_cast<int>(random.below(2)), sign};
        const double z = low + length * random.between(0.3, 0.7);
        addNozzle(writer, floor + side.vector() * (radius - 0.05) + glm::dvec3(0, 0, z), side, 0.3, 0.057,
                  color);
    }
    addCylinder(writer, floor + glm::dvec3(radius * 0.6, 0, low + length * 0.45), {0, 1}, radius * 0.5, 0.28,
                32,
                color);  // manhole
}

// A horizontal vessel on saddles, its tubes' flanges at one end: a heat exchanger.
void addExchanger(PartWriter& writer, const glm::dvec3& floor, Random& random) {
    const Direction direction{static_cast<int>(random.below(2)), 1};
    const double radius = random.between(0.3, 0.5), length = 2.4, height = radius + 0.5;
    const Rgb color = kTanks[random.below(kTanks.size())];
    const glm::dvec3 along = direction.vector(), start = floor - along * (length / 2);
    const glm::dvec3 middle(0, 0, height);
    addVessel(writer, start + middle, direction, length, radius, color);
    for (const double at : {0.45, 0.53}) {  // the tube sheet's flanges
        addCylinder(writer, start + along * at + middle, direction, 0.06, radius * 1.15, sidesFor(radius),
                    color);
    }
    for (const double at : {0.7, 1.8}) {
        const glm::dvec3 saddle = start + along * at;
        const glm::dvec3 half = glm::dvec3(radius * 0.8) - along * (radius * 0.8 - 0.06);
        addBox(writer, saddle - glm::dvec3(half.x, half.y, 0),
               saddle + glm::dvec3(half.x, half.y, height - radius * 0.6), kLeg);
    }
    for (const double at : {0.25, 1.0, 2.0}) {
        addNozzle(writer, start + along * at + glm::dvec3(0, 0, height + radius * 0.8), kUp, 0.3, 0.07,
                  color);
    }
}

// A motor with cooling fins drives a pump, on a common skid.
void addPumpSet(PartWriter& writer, const glm::dvec3& floor, Random& random) {
    const Direction direction{static_cast<int>(random.below(2)), 1};
    const double radius = random.between(0.16, 0.26), height = 0.2 + radius * 1.25;
    const glm::dvec3 along = direction.vector(), axis = floor + glm::dvec3(0, 0, height);
    const glm::dvec3 half = glm::dvec3(radius * 1.2, radius * 1.2, 0) + along * (0.95 - radius * 1.2);
    addBox(writer, floor - half, floor + half + glm::dvec3(0, 0, 0.16), kSkid);
    std::vector<Station> fins{{0, radius * 0.8}};
    for (int i = 0; i < 14; ++i) {
        const double at = 0.06 + 0.04 * i;
        fins.push_back({at, radius}), fins.push_back({at + 0.012, radius});
        fins.push_back({at + 0.016, radius * 0.88}), fins.push_back({at + 0.036, radius * 0.88});
    }
    fins.push_back({0.64, radius * 0.8});
    addRevolved(writer, axis - along * 0.85, direction, fins, 28, kMotor);
    addBox(writer, axis + glm::dvec3(-0.09, -0.09, radius * 0.8) - along * 0.5,
           axis + glm::dvec3(0.09, 0.09, radius * 1.35) - along * 0.5, kMotor);
    addCylinder(writer, axis - along * 0.22, direction, 0.5, 0.035, 16, kDark);
    addCylinder(writer, axis - along * 0.1, direction, 0.12, radius * 0.45, 24, kRail);
    const std::array<Station, 6> volute{{{0, radius * 0.5},
                                         {0.06, radius * 1.1},
                                         {0.14, radius * 1.35},
                                         {0.26, radius * 1.35},
                                         {0.34, radius * 1.1},
                                         {0.4, radius * 0.5}}};
    addRevolved(writer, axis + along * 0.25, direction, volute, 36, kPump);
    addNozzle(writer, axis + along * 0.6, direction, 0.25, radius * 0.4, kPump);
    addNozzle(writer, axis + along * 0.45 + glm::dvec3(0, 0, radius), kUp, 0.3, radius * 0.35, kPump);
    for (const double at : {-0.7, -0.35, 0.4}) {
        addBox(writer, floor + along * at + glm::dvec3(-0.08, -0.08, 0.16),
               floor + along * at + glm::dvec3(0.08, 0.08, height - radius * 0.6), kSkid);
    }
}

// Switchgear: a row of cabinets with doors, handles and lamps.
void addCabinets(PartWriter& writer, const glm::dvec3& floor, Random& random) {
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 corner = floor + glm::dvec3(-1.2 + 0.8 * i, -0.3, 0);
        addBox(writer, corner, corner + glm::dvec3(0.78, 0.6, 0.1), kDark);
        addBox(writer, corner + glm::dvec3(0, 0, 0.1), corner + glm::dvec3(0.78, 0.6, 2.1), kCabinet);
        for (const double y : {-0.02, 0.6}) {
            addBox(writer, corner + glm::dvec3(0.04, y, 0.15), corner + glm::dvec3(0.74, y + 0.02, 2.05),
                   kCabinet);
            addCylinder(writer, corner + glm::dvec3(0.66, y + 0.01, 1.05), kUp, 0.18, 0.03, 12, kDark);
            for (int lamp = 0; lamp < 4; ++lamp) {
                addCylinder(writer, corner + glm::dvec3(0.2 + 0.1 * lamp, y - 0.02, 1.8), {1, 1}, 0.06, 0.02,
                            16, random.chance(0.5) ? kLamp : kRail);
            }
            for (int slit = 0; slit < 8; ++slit) {
                addBox(writer, corner + glm::dvec3(0.15, y - 0.005, 0.3 + 0.05 * slit),
                       corner + glm::dvec3(0.6, y + 0.025, 0.32 + 0.05 * slit), kDark);
            }
        }
    }
}

// A platform of grating with a rail around it and a ladder.
void addPlatform(PartWriter& writer, const glm::dvec3& floor, Random& random) {
    const double half = 1.15, height = random.between(1.0, 1.8);
    const auto at = [&](double x, double y, double z) { return floor + glm::dvec3(x, y, z); };
    for (const double x : {-half, half}) {
        for (const double y : {-half, half})
            addCylinder(writer, at(x, y, 0), kUp, height + 1.1, 0.03, 12, kRail);
        addBox(writer, at(x - 0.02, -half, height - 0.12), at(x + 0.02, half, height), kLeg);
        addBox(writer, at(-half, x - 0.02, height - 0.12), at(half, x + 0.02, height), kLeg);
    }
    for (double x = -half + 0.04; x < half; x += 0.05) {
        addBox(writer, at(x - 0.003, -half, height - 0.04), at(x + 0.003, half, height), kGrating);
        addBox(writer, at(-half, x - 0.003, height - 0.03), at(half, x + 0.003, height - 0.01), kGrating);
    }
    for (const double z : {0.55, 1.1}) {
        for (const double side : {-half, half}) {
            addCylinder(writer, at(-half, side, height + z), {0, 1}, 2 * half, 0.022, 12, kRail);
        }
        addCylinder(writer, at(half, -half, height + z), {1, 1}, 2 * half, 0.022, 12, kRail);
    }
    for (const double y : {-0.25, 0.25})
        addCylinder(writer, at(-half - 0.1, y, 0), kUp, height + 1.1, 0.022, 12, kRail);
    for (double z = 0.25; z < height; z += 0.28) {
        addCylinder(writer, at(-half - 0.1, -0.25, z), {1, 1}, 0.5, 0.014, 10, kLeg);
    }
}

}  // namespace

void addEquipment(PartWriter& writer, const Bay& bay, std::uint32_t quarter, Random& random) {
    const double low = kAisleLow / 2, high = kBaySide - kAisleLow / 2;
    const glm::dvec3 floor = bay.at((quarter & 1) != 0 ? high : low, (quarter & 2) != 0 ? high : low, 0);
    switch (random.below(6)) {
        case 0:
        case 1:
            return addTank(writer, floor, random);
        case 2:
            return addExchanger(writer, floor, random);
        case 3:
            addPumpSet(writer, floor + glm::dvec3(-0.6, -0.6, 0), random);
            return addPumpSet(writer, floor + glm::dvec3(0.6, 0.6, 0), random);
        case 4:
            return addCabinets(writer, floor, random);
        default:
            return addPlatform(writer, floor, random);
    }
}

}  // namespace iwalk
