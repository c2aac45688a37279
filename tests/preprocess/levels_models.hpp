#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "tests/preprocess/soup.hpp"

// Models whose levels are hard to make, each in its own way.
namespace iwalk {

// A closed sphere with bumps and a noise of its points: 12 n^2 triangles.
FakeInput noisySphere(unsigned n, double bumps = 0.05, double noise = 1e-3);

// `count` triangles around one point, as the ribs of a fan that is no plane.
FakeInput fan(unsigned count);

// Part of a process plant.
FakeInput plant(std::uint64_t triangles);

// Several times the same small patch, and the same triangle, both ways round.
FakeInput duplicates();

// A soup, and one triangle as large as all of it.
FakeInput largeAmongSmall();

// A model and how to build it. The name is for gtest.
struct LevelModelCase {
    std::string name;
    FakeInput (*make)();
    std::uint32_t leafTriangles;
};
inline std::ostream& operator<<(std::ostream& out, const LevelModelCase& model) {
    return out << model.name;
}

// All kinds, the tiniest included.
std::vector<LevelModelCase> levelModels();

}  // namespace iwalk
