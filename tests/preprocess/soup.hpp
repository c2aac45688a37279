#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/dataset/page.hpp"
#include "preprocess/build/pipeline.hpp"

namespace iwalk {

// An input made of triangles in memory, or of an error in the middle of them.
struct FakeInput {
    std::vector<Triangle> triangles;
    bool colors = false, normals = false;
    double precision = 0x1p-23;
    std::size_t failAfter = ~std::size_t{0};  // triangles, then an error
};

// Inputs by their path: what BuildParts::openImporter needs.
ImporterFactory fakeImporters(std::vector<std::pair<std::string, FakeInput>> inputs);

// Triangles around normally distributed points with sizes from `smallest` to `largest`, evenly in their
// logarithm.
FakeInput makeSoup(std::size_t triangles, double smallest, double largest, unsigned seed,
                   bool attributes = false);

Triangle makeTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

// Writes a binary PLY of float positions.
void writePly(const std::string& path, const std::vector<Triangle>& triangles);

// A triangle as a dataset has it, in a form that does not depend on where it starts: positions on the
// lattice, then colour, then normal, corner by corner.
using StoredTriangle = std::array<std::int64_t, 15>;

// All triangles of a dataset, sorted. Expects that it loads.
std::vector<StoredTriangle> readTriangles(const std::string& dataset);

// What `input` should be in a dataset with this step, sorted; degenerate triangles left out.
std::vector<StoredTriangle> quantised(const std::vector<Triangle>& triangles, int stepExponent, bool colors,
                                      bool normals);

class NoProgress : public Progress {
  public:
    void phase(const std::string&) override {}
    void done(double part) override { last = part; }
    double last = 0;
};

// The options that tests choose, each by its name.
struct Chosen {
    std::uint64_t memoryBytes = std::uint64_t{512} << 20;
    std::uint32_t leafTriangles = 16384;
    std::optional<int> stepExponent = std::nullopt;
    unsigned threads = 0;
};

// Builds from the one fake input into `output`.
Result<Manifest> buildFrom(const FakeInput& input, const std::string& output, const Chosen& chosen = {},
                           BuildParts parts = {});

}  // namespace iwalk
