#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "preprocess/generate/generate.hpp"

namespace iwalk {

struct QuietProgress : Progress {
    void phase(const std::string&) override {}
    void done(double) override {}
};

struct Model {
    std::vector<glm::vec3> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Generates to `path`; expects success.
Generated generate(const std::string& scene, std::uint64_t triangles, const std::string& path,
                   std::uint64_t seed = 1);
// Reads a file as generate() writes it; expects that nothing is missing and nothing left over.
Model readModel(const std::string& path);

// Edges that have not exactly one triangle on either side.
struct OpenEdges {
    std::vector<std::array<std::uint32_t, 2>> once;  // one triangle
    std::size_t bad = 0;  // more than two, or two that are turned against each other
};
OpenEdges openEdges(const Model& model);

}  // namespace iwalk
