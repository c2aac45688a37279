#include "tests/generate/generated.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "common/file.hpp"

namespace iwalk {
namespace {

// The number after `element NAME ` in the header.
std::size_t countOf(const std::string& header, const std::string& name) {
    const std::size_t at = header.find("element " + name + " ");
    return at == std::string::npos ? 0 : std::stoul(header.substr(at + 9 + name.size()));
}

}  // namespace

Generated generate(const std::string& scene, std::uint64_t triangles, const std::string& path,
                   std::uint64_t seed) {
    QuietProgress progress;
    GenerateOptions options;
    options.scene = scene;
    options.triangles = triangles;
    options.seed = seed;
    options.output = path;
    const auto generated = generateScene(options, progress);
    EXPECT_TRUE(generated.ok()) << generated.error().message;
    return generated ? *generated : Generated{};
}

Model readModel(const std::string& path) {
    const std::string bytes = readWholeFile(path, 1u << 30).value();
    const std::size_t start = bytes.find("end_header\n") + 11;
    const std::string header = bytes.substr(0, start);
    const std::size_t vertexBytes = header.find("red") == std::string::npos ? 12 : 15;
    Model model;
    model.positions.resize(countOf(header, "vertex"));
    model.triangles.resize(countOf(header, "face"));
    EXPECT_EQ(bytes.size(), start + model.positions.size() * vertexBytes + model.triangles.size() * 13);
    const char* at = bytes.data() + start;
    for (glm::vec3& position : model.positions) {
        std::memcpy(&position, at, 12);
        at += vertexBytes;
    }
    for (auto& triangle : model.triangles) {
        EXPECT_EQ(*at, 3);
        std::memcpy(triangle.data(), at + 1, 12);
        at += 13;
        for (const std::uint32_t vertex : triangle) EXPECT_LT(vertex, model.positions.size());
    }
    return model;
}

OpenEdges openEdges(const Model& model) {
    std::map<std::array<std::uint32_t, 2>, int> directed;
    for (const auto& triangle : model.triangles) {
        for (std::size_t i = 0; i < 3; ++i) ++directed[{triangle[i], triangle[(i + 1) % 3]}];
    }
    OpenEdges open;
    for (const auto& [edge, count] : directed) {
        if (count != 1) ++open.bad;
        if (!directed.contains({edge[1], edge[0]})) open.once.push_back(edge);
    }
    return open;
}

}  // namespace iwalk
