#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "preprocess/generate/part_writer.hpp"
#include "preprocess/generate/random.hpp"

namespace iwalk {

inline constexpr double kBaySide = 8, kStoreyHeight = 5;  // metres

// One room of the plant, and what is around it. Two aisles cross in the middle of its floor; they stay free
// up to kAisleHeight, so that one can walk from bay to bay.
struct Bay {
    std::uint32_t x = 0, y = 0, storey = 0;
    bool lastX = false, lastY = false, top = false;
    std::uint64_t seed = 0;  // of the plant
    std::uint64_t goal = 0;  // triangles that the plant has, as near as can be, when this bay is finished

    glm::dvec3 origin() const { return {kBaySide * x, kBaySide * y, kStoreyHeight * storey}; }
    glm::dvec3 at(double dx, double dy, double dz) const { return origin() + glm::dvec3(dx, dy, dz); }
    std::uint64_t left(const PartWriter& writer) const {  // triangles up to the goal
        return goal > writer.triangles() ? goal - writer.triangles() : 0;
    }
};

inline constexpr double kAisleHeight = 2.5;                 // metres
inline constexpr double kAisleLow = 3.1, kAisleHigh = 4.9;  // its sides, from the bay's corner

// The bay's building: floor, columns, girders, walls with doors.
void addStructure(PartWriter& writer, const Bay& bay);
// A machine with what belongs to it, in one of the bay's four quarters.
void addEquipment(PartWriter& writer, const Bay& bay, std::uint32_t quarter, Random& random);
// Straight pipes under the ceiling that go on in the next bays, and trays with cables.
void addMains(PartWriter& writer, const Bay& bay);
// A pipe with bends, flanges and valves, somewhere in the bay: 500 to 6000 triangles.
void addPipe(PartWriter& writer, const Bay& bay, Random& random);

// To use up the last triangles: an upright pipe, a conduit, a plate on the floor. With the most triangles
// they have.
void addRiser(PartWriter& writer, const Bay& bay, Random& random);
void addConduit(PartWriter& writer, const Bay& bay, Random& random);
void addPlate(PartWriter& writer, const Bay& bay, Random& random);
inline constexpr std::uint64_t kLargestRiser = 900, kConduit = 28, kPlate = 12;

}  // namespace iwalk
