#include "preprocess/generate/plant_bay.hpp"
#include "preprocess/generate/plant_shapes.hpp"

namespace iwalk {
namespace {

constexpr Rgb kConcrete{150, 149, 144}, kPlaster{206, 204, 194}, kBrick{168, 116, 92}, kSteel{74, 92, 112},
    kFrame{60, 66, 72}, kStripe{226, 186, 40};
constexpr double kSlab = 0.25, kWall = 0.2, kGirder = 0.4;  // thickness, height
constexpr double kDoorWidth = 1.4, kDoorHeight = 2.3, kFrameWidth = 0.08;
constexpr double kInnerWalls = 0.4;  // share of the sides between two bays that have a wall

// A wall along x (axis 0) or y (axis 1), from `corner` on, with a door in its middle, or a window whose sill
// is `sill` above the floor.
class Wall {
  public:
    Wall(const glm::dvec3& corner, int axis, double sill = 0) : corner_(corner), axis_(axis), sill_(sill) {}

    void add(PartWriter& writer, Rgb color) const {
        const double left = (kBaySide - kDoorWidth) / 2, right = (kBaySide + kDoorWidth) / 2;
        const double top = kStoreyHeight - kSlab;
        panel(writer, 0, left, 0, top, kWall, color);
        panel(writer, right, kBaySide, 0, top, kWall, color);
        panel(writer, left, right, kDoorHeight, top, kWall, color);
        const double thick = kWall + 0.06;
        if (sill_ > 0) {
            panel(writer, left, right, 0, sill_, kWall, color);
            panel(writer, left, right, sill_, sill_ + kFrameWidth, thick, kFrame);
        }
        panel(writer, left - kFrameWidth, left, sill_, kDoorHeight, thick, kFrame);
        panel(writer, right, right + kFrameWidth, sill_, kDoorHeight, thick, kFrame);
        panel(writer, left - kFrameWidth, right + kFrameWidth, kDoorHeight, kDoorHeight + kFrameWidth, thick,
              kFrame);
    }

  private:
    void panel(PartWriter& writer, double from, double to, double low, double high, double thick,
               Rgb color) const {
        const double side = thick / 2;
        if (axis_ == 0) {
            addBox(writer, corner_ + glm::dvec3(from, -side, low), corner_ + glm::dvec3(to, side, high),
                   color);
        } else {
            addBox(writer, corner_ + glm::dvec3(-side, from, low), corner_ + glm::dvec3(side, to, high),
                   color);
        }
    }
    glm::dvec3 corner_;
    int axis_;
    double sill_;
};

void addColumn(PartWriter& writer, const Bay& bay, double x, double y) {
    addBeam(writer, bay.at(x, y, 0), bay.at(x, y, kStoreyHeight - kSlab), 0.36, kSteel);
}

// Girders under the ceiling: on the bay's two near sides, and joists between them.
void addGirders(PartWriter& writer, const Bay& bay) {
    const double z = kStoreyHeight - kSlab - kGirder / 2;
    addBeam(writer, bay.at(0.2, 0, z), bay.at(kBaySide - 0.2, 0, z), kGirder, kSteel);
    addBeam(writer, bay.at(0, 0.2, z), bay.at(0, kBaySide - 0.2, z), kGirder, kSteel);
    for (const double y : {2.0, 4.0, 6.0}) {
        addBeam(writer, bay.at(0.1, y, z + 0.08), bay.at(kBaySide - 0.1, y, z + 0.08), kGirder * 0.6, kSteel);
    }
}

}  // namespace

void addStructure(PartWriter& writer, const Bay& bay) {
    Random random(seedOf(bay.seed, 1, bay.x + 4096 * std::uint64_t{bay.y}, bay.storey));
    addBox(writer, bay.at(0, 0, -kSlab), bay.at(kBaySide, kBaySide, 0), kConcrete);
    if (bay.top) {
        addBox(writer, bay.at(0, 0, kStoreyHeight - kSlab), bay.at(kBaySide, kBaySide, kStoreyHeight),
               kConcrete);
    }
    addColumn(writer, bay, 0, 0);
    if (bay.lastX) addColumn(writer, bay, kBaySide, 0);
    if (bay.lastY) addColumn(writer, bay, 0, kBaySide);
    if (bay.lastX && bay.lastY) addColumn(writer, bay, kBaySide, kBaySide);
    addGirders(writer, bay);
    const bool wallX = random.chance(kInnerWalls), wallY = random.chance(kInnerWalls);
    const double sill = bay.storey == 0 ? 0 : 1;  // of outer walls: doors below, windows above
    if (bay.y == 0) Wall(bay.origin(), 0, sill).add(writer, kBrick);
    if (bay.x == 0) Wall(bay.origin(), 1, sill).add(writer, kBrick);
    if (bay.y > 0 && wallX) Wall(bay.origin(), 0).add(writer, kPlaster);
    if (bay.x > 0 && wallY) Wall(bay.origin(), 1).add(writer, kPlaster);
    if (bay.lastY) Wall(bay.at(0, kBaySide, 0), 0, sill).add(writer, kBrick);
    if (bay.lastX) Wall(bay.at(kBaySide, 0, 0), 1, sill).add(writer, kBrick);
    for (const double y : {kAisleLow, kAisleHigh}) {  // the aisle's lines on the floor
        addBox(writer, bay.at(0.3, y - 0.05, 0.001), bay.at(kBaySide - 0.3, y + 0.05, 0.004), kStripe);
    }
}

}  // namespace iwalk
