#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>

#include "common/settings.hpp"
#include "preprocess/build/compact.hpp"
#include "preprocess/command/commands.hpp"
#include "preprocess/command/summary.hpp"

namespace iwalk {
namespace {

using nlohmann::ordered_json;

double ratio(std::uint64_t a, std::uint64_t b) {
    return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b);
}

ordered_json levelJson(const LevelSummary& level, const StoredLevel& stored) {
    return {{"error", level.error},  {"triangles", level.triangles},
            {"bytes", level.bytes},  {"entries", stored.entries},
            {"pages", stored.pages}, {"stored_triangles", stored.triangles}};
}

void addTreeJson(const Manifest& manifest, const Summary& summary, ordered_json& json) {
    json["depths"] = ordered_json::array();
    for (const DepthSummary& depth : summary.depths) {
        json["depths"].push_back(
            {{"nodes", depth.nodes}, {"leaves", depth.leaves}, {"triangles", depth.triangles}});
    }
    json["levels"] = ordered_json::array();
    for (std::size_t level = 0; level < manifest.levels.size(); ++level) {
        json["levels"].push_back(levelJson(manifest.levels[level], summary.levels[level]));
    }
    json["full"] = levelJson(manifest.full, summary.full);
    if (summary.hasOpacity) json["opacity_histogram"] = summary.opacities;
}

ordered_json toJson(const Manifest& manifest, const Hierarchy& hierarchy, const Summary& summary) {
    ordered_json json;
    json["version"] = kDatasetVersion;
    json["generation"] = manifest.generation;
    json["triangles"] = manifest.triangles;
    json["vertices"] = manifest.vertices;
    json["bytes"] = bytesOnDisk(manifest);
    json["bytes_per_triangle"] = ratio(bytesOnDisk(manifest), manifest.triangles);
    json["garbage_bytes"] = garbageBytes(manifest);
    json["nodes"] = manifest.nodes;
    json["leaves"] = manifest.leaves;
    json["pages"] = manifest.pages;
    json["leaf_triangles"] = manifest.leafTriangles;
    json["ranges"] = summary.ranges;
    json["attributes"] = {{"colors", manifest.colors}, {"normals", manifest.normals}};
    json["bounds"]["min"] = {manifest.bounds.min.x, manifest.bounds.min.y, manifest.bounds.min.z};
    json["bounds"]["max"] = {manifest.bounds.max.x, manifest.bounds.max.y, manifest.bounds.max.z};
    json["step_exponent"] = manifest.stepExponent;
    json["root_cell_log2"] = hierarchy.rootCellLog2;
    addTreeJson(manifest, summary, json);
    json["provenance"] = ordered_json::array();
    for (const Provenance& input : manifest.provenance) {
        json["provenance"].push_back({{"input", input.input},
                                      {"triangles", input.triangles},
                                      {"dropped_non_finite", input.droppedNonFinite},
                                      {"dropped_degenerate", input.droppedDegenerate},
                                      {"split", input.split},
                                      {"cut", input.cut}});
    }
    return json;
}

void printTree(const Manifest& manifest, const Summary& summary) {
    fmt::print("tree:       {} nodes, {} leaves; nodes with more than {} triangles are split\n",
               manifest.nodes, manifest.leaves, manifest.leafTriangles);
    for (std::size_t depth = 0; depth < summary.depths.size(); ++depth) {
        const DepthSummary& at = summary.depths[depth];
        fmt::print("  depth {:2}: {:8} nodes {:8} leaves {:12} triangles\n", depth, at.nodes, at.leaves,
                   at.triangles);
    }
}

void printLevel(const std::string& name, const LevelSummary& level, const StoredLevel& stored) {
    fmt::print("  level {:>4}: {:12} triangles, error {:<11.5g} {:8} entries {:7} pages {:>9}\n", name,
               level.triangles, level.error, stored.entries, stored.pages, formatBytes(level.bytes));
}

void printLevels(const Manifest& manifest, const Summary& summary) {
    fmt::print("levels:     triangles of the whole model; error in model units\n");
    for (std::size_t level = 0; level < manifest.levels.size(); ++level) {
        printLevel(std::to_string(level), manifest.levels[level], summary.levels[level]);
    }
    printLevel("full", manifest.full, summary.full);
    fmt::print("pages:      {} of {} on average, {} wide; {} ranges of {:.0f} triangles on average\n",
               manifest.pages, formatBytes(manifest.pages == 0 ? 0 : summary.pageBytes / manifest.pages),
               summary.widePages, summary.ranges, ratio(summary.triangles, summary.ranges));
    if (summary.morphBytes > 0) fmt::print("morphs:     {}\n", formatBytes(summary.morphBytes));
}

void printOpacities(const Summary& summary) {
    if (!summary.hasOpacity) return;
    const std::uint64_t all =
        std::accumulate(summary.opacities.begin(), summary.opacities.end(), std::uint64_t{0});
    fmt::print("opacity:    of the leaves, in {} directions\n", kOpacityDirections);
    for (std::size_t bin = 0; bin < kOpacityBins; ++bin) {
        const double part = ratio(summary.opacities[bin], all);
        fmt::print("  {:.1f} to {:.1f}: {:5.1f} % {}\n", static_cast<double>(bin) / kOpacityBins,
                   static_cast<double>(bin + 1) / kOpacityBins, 100 * part,
                   std::string(static_cast<std::size_t>(std::lround(60 * part)), '#'));
    }
}

void print(const Manifest& manifest, const Hierarchy& hierarchy, const Summary& summary) {
    const glm::dvec3 &low = manifest.bounds.min, &high = manifest.bounds.max;
    fmt::print("version:    {}, generation {}\n", kDatasetVersion, manifest.generation);
    fmt::print("triangles:  {}\nvertices:   {} in pages\n", manifest.triangles, manifest.vertices);
    fmt::print("size:       {}, {:.2f} bytes/triangle\n", formatBytes(bytesOnDisk(manifest)),
               ratio(bytesOnDisk(manifest), manifest.triangles));
    if (const std::uint64_t garbage = garbageBytes(manifest); garbage > 0) {
        fmt::print("garbage:    {} of that, which inserts have left: iwalk-preprocess compact removes it\n",
                   formatBytes(garbage));
    }
    fmt::print("attributes: {}{}{}\n", manifest.colors ? "colors " : "", manifest.normals ? "normals" : "",
               manifest.colors || manifest.normals ? "" : "none");
    fmt::print("bounds:     ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) model units\n", low.x, low.y, low.z,
               high.x, high.y, high.z);
    fmt::print("lattice:    step 2^{} = {:g} model units, root cell of 2^{} steps\n", manifest.stepExponent,
               std::ldexp(1.0, manifest.stepExponent), hierarchy.rootCellLog2);
    printTree(manifest, summary);
    printLevels(manifest, summary);
    printOpacities(summary);
    for (const Provenance& input : manifest.provenance) {
        fmt::print("input:      {}: {} triangles; left out: {} not finite, {} degenerate\n", input.input,
                   input.triangles, input.droppedNonFinite, input.droppedDegenerate);
        if (input.split + input.cut > 0) {
            fmt::print("            too long for a page: {} split, {} cut off far from the middle\n",
                       input.split, input.cut);
        }
    }
}

// Becomes the program that draws, which is beside this one. What it takes to write PNG files is loaded when a
// program starts: 128 MB that builds would have to do without.
Result<void> drawPicture(const std::string& dataset, const std::string& picture) {
    std::error_code error;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    const std::string program = self.parent_path() / "iwalk-octree-picture";
    ::execl(program.c_str(), program.c_str(), dataset.c_str(), picture.c_str(), nullptr);
    return fail("{}: cannot be started: {}", program, std::strerror(errno));
}

}  // namespace

Result<void> runInfo(const std::string& dataset, bool json, const std::string& picture) {
    ASSIGN_OR_RETURN(const Manifest manifest, loadManifest(dataset));
    ASSIGN_OR_RETURN(const Hierarchy hierarchy, loadHierarchy(dataset, manifest));
    const Summary summary = summarise(hierarchy);
    if (json) {
        fmt::print("{}\n", toJson(manifest, hierarchy, summary).dump(2));
    } else {
        print(manifest, hierarchy, summary);
    }
    std::fflush(stdout);
    return picture.empty() ? Result<void>() : drawPicture(dataset, picture);
}

}  // namespace iwalk
