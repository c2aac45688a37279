// The plant has a bay for every so many triangles. Bays are made one after the other, each up to its share of
// the goal: first the building, then machines, mains and trays, then pipes until the share is used up; the
// last triangles go into small parts. What a bay has too much or too little the next one makes good.
#include "preprocess/generate/plant.hpp"

#include <algorithm>
#include <cmath>

#include "preprocess/generate/plant_bay.hpp"

namespace iwalk {
namespace {

constexpr std::uint64_t kTrianglesPerBay = 140'000;
constexpr std::uint32_t kMostStoreys = 8;
constexpr std::uint64_t kLargestMachine = 8'000, kLargestPipe = 6'000, kUsualPipe = 1'500;  // triangles

struct Size {
    std::uint32_t x = 1, y = 1, storeys = 1;  // bays
    std::uint64_t bays() const { return std::uint64_t{x} * y * storeys; }
};

Size sizeFor(std::uint64_t triangles) {
    const std::uint64_t bays = std::max<std::uint64_t>(1, triangles / kTrianglesPerBay);
    Size size;
    const auto cube = [](std::uint64_t n) { return n * n * n; };
    while (size.storeys < kMostStoreys && cube(size.storeys + 1) <= bays) ++size.storeys;
    const std::uint64_t perStorey = bays / size.storeys;
    size.x = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(perStorey)));
    size.y = static_cast<std::uint32_t>(perStorey / size.x);
    return size;
}

// In the last bay: what is as near the goal as can be.
void finish(PartWriter& writer, const Bay& bay, Random& random) {
    while (bay.left(writer) > kLargestRiser) addRiser(writer, bay, random);
    while (bay.left(writer) > 2 * kConduit) addConduit(writer, bay, random);
    while (bay.left(writer) > kPlate / 2) addPlate(writer, bay, random);
}

void addBay(PartWriter& writer, const Bay& bay) {
    Random random(seedOf(bay.seed, 2, bay.x + 4096 * std::uint64_t{bay.y}, bay.storey));
    const bool last = bay.lastX && bay.lastY && bay.top;
    addStructure(writer, bay);
    for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
        if (bay.left(writer) > 4 * kLargestMachine) addEquipment(writer, bay, quarter, random);
    }
    addMains(writer, bay);
    while (bay.left(writer) > (last ? kLargestPipe : kUsualPipe)) addPipe(writer, bay, random);
    if (last) finish(writer, bay, random);
}

class Plant {
  public:
    Plant(std::uint64_t triangles, std::uint64_t seed)
        : size_(sizeFor(triangles)), goal_(triangles), seed_(seed) {}

    Result<void> write(PartWriter& writer, Progress& progress) const {
        for (std::uint64_t i = 0; i < size_.bays(); ++i) {
            addBay(writer, bay(i));
            RETURN_IF_ERROR(writer.status());
            progress.done(static_cast<double>(i + 1) / static_cast<double>(size_.bays()));
        }
        return {};
    }

  private:
    Bay bay(std::uint64_t i) const {
        Bay bay;
        bay.x = static_cast<std::uint32_t>(i % size_.x);
        bay.y = static_cast<std::uint32_t>(i / size_.x % size_.y);
        bay.storey = static_cast<std::uint32_t>(i / size_.x / size_.y);
        bay.lastX = bay.x + 1 == size_.x;
        bay.lastY = bay.y + 1 == size_.y;
        bay.top = bay.storey + 1 == size_.storeys;
        bay.seed = seed_;
        bay.goal = static_cast<std::uint64_t>(static_cast<double>(goal_) * static_cast<double>(i + 1) /
                                              static_cast<double>(size_.bays()));
        return bay;
    }

    Size size_;
    std::uint64_t goal_, seed_;
};

}  // namespace

Result<void> generatePlant(std::uint64_t triangles, std::uint64_t seed, PlyOutput& output,
                           Progress& progress) {
    const Plant plant(triangles, seed);
    progress.phase("vertices");
    PartWriter vertices(output, Pass::vertices);
    RETURN_IF_ERROR(plant.write(vertices, progress));
    progress.phase("triangles");
    PartWriter faces(output, Pass::triangles);
    return plant.write(faces, progress);
}

}  // namespace iwalk
