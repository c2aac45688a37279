#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/dataset/hierarchy.hpp"
#include "common/settings.hpp"
#include "preprocess/command/commands.hpp"

namespace iwalk {
namespace {

using nlohmann::ordered_json;

// What one depth of the tree has.
struct DepthSummary {
    std::uint64_t nodes = 0, leaves = 0, triangles = 0;
};

std::vector<DepthSummary> summarise(const Hierarchy& hierarchy) {
    std::vector<DepthSummary> depths;
    for (const NodeRecord& node : hierarchy.nodes) {
        if (node.depth >= depths.size()) depths.resize(std::size_t{node.depth} + 1);
        DepthSummary& depth = depths[node.depth];
        ++depth.nodes;
        depth.leaves += node.childMask == 0 ? 1 : 0;
        depth.triangles += node.triangles;
    }
    return depths;
}

std::uint64_t bytesOnDisk(const Manifest& manifest) {
    std::uint64_t bytes = manifest.hierarchy.bytes;
    for (const DatasetFile& file : manifest.pageFiles) bytes += file.bytes;
    return bytes;
}

double ratio(std::uint64_t a, std::uint64_t b) {
    return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b);
}

std::uint64_t rangesOf(const Hierarchy& hierarchy) {
    std::uint64_t ranges = 0;
    for (const PageRecord& page : hierarchy.pages) ranges += page.rangeCount;
    return ranges;
}

ordered_json toJson(const Manifest& manifest, const Hierarchy& hierarchy) {
    ordered_json json;
    json["version"] = kDatasetVersion;
    json["generation"] = manifest.generation;
    json["triangles"] = manifest.triangles;
    json["vertices"] = manifest.vertices;
    json["bytes"] = bytesOnDisk(manifest);
    json["bytes_per_triangle"] = ratio(bytesOnDisk(manifest), manifest.triangles);
    json["nodes"] = manifest.nodes;
    json["leaves"] = manifest.leaves;
    json["pages"] = manifest.pages;
    json["ranges"] = rangesOf(hierarchy);
    json["attributes"] = {{"colors", manifest.colors}, {"normals", manifest.normals}};
    json["bounds"]["min"] = {manifest.bounds.min.x, manifest.bounds.min.y, manifest.bounds.min.z};
    json["bounds"]["max"] = {manifest.bounds.max.x, manifest.bounds.max.y, manifest.bounds.max.z};
    json["step_exponent"] = manifest.stepExponent;
    json["root_cell_log2"] = hierarchy.rootCellLog2;
    json["depths"] = ordered_json::array();
    for (const DepthSummary& depth : summarise(hierarchy)) {
        json["depths"].push_back(
            {{"nodes", depth.nodes}, {"leaves", depth.leaves}, {"triangles", depth.triangles}});
    }
    json["provenance"] = ordered_json::array();
    for (const Provenance& input : manifest.provenance) {
        json["provenance"].push_back({{"input", input.input},
                                      {"triangles", input.triangles},
                                      {"dropped_non_finite", input.droppedNonFinite},
                                      {"dropped_degenerate", input.droppedDegenerate}});
    }
    return json;
}

void printTree(const Manifest& manifest, const Hierarchy& hierarchy) {
    fmt::print("tree:       {} nodes, {} leaves\n", manifest.nodes, manifest.leaves);
    const std::vector<DepthSummary> depths = summarise(hierarchy);
    for (std::size_t depth = 0; depth < depths.size(); ++depth) {
        fmt::print("  depth {:2}: {:8} nodes {:8} leaves {:12} triangles\n", depth, depths[depth].nodes,
                   depths[depth].leaves, depths[depth].triangles);
    }
    const std::uint64_t pages = manifest.pages, ranges = rangesOf(hierarchy);
    std::uint64_t wide = 0, bytes = 0;
    for (const PageRecord& page : hierarchy.pages) {
        wide += (page.flags & kPageWide) != 0 ? 1 : 0;
        bytes += page.bytes;
    }
    fmt::print("pages:      {} of {} on average, {} wide; {} ranges of {:.0f} triangles on average\n", pages,
               formatBytes(pages == 0 ? 0 : bytes / pages), wide, ranges, ratio(manifest.triangles, ranges));
}

void print(const Manifest& manifest, const Hierarchy& hierarchy) {
    const glm::dvec3 &low = manifest.bounds.min, &high = manifest.bounds.max;
    fmt::print("version:    {}, generation {}\n", kDatasetVersion, manifest.generation);
    fmt::print("triangles:  {}\nvertices:   {} in pages\n", manifest.triangles, manifest.vertices);
    fmt::print("size:       {}, {:.2f} bytes/triangle\n", formatBytes(bytesOnDisk(manifest)),
               ratio(bytesOnDisk(manifest), manifest.triangles));
    fmt::print("attributes: {}{}{}\n", manifest.colors ? "colors " : "", manifest.normals ? "normals" : "",
               manifest.colors || manifest.normals ? "" : "none");
    fmt::print("bounds:     ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}) model units\n", low.x, low.y, low.z,
               high.x, high.y, high.z);
    fmt::print("lattice:    step 2^{} = {:g} model units, root cell of 2^{} steps\n", manifest.stepExponent,
               std::ldexp(1.0, manifest.stepExponent), hierarchy.rootCellLog2);
    printTree(manifest, hierarchy);
    for (const Provenance& input : manifest.provenance) {
        fmt::print("input:      {}: {} triangles; left out: {} not finite, {} degenerate\n", input.input,
                   input.triangles, input.droppedNonFinite, input.droppedDegenerate);
    }
}

}  // namespace

Result<void> runInfo(const std::string& dataset, bool json) {
    ASSIGN_OR_RETURN(const Manifest manifest, loadManifest(dataset));
    ASSIGN_OR_RETURN(const Hierarchy hierarchy, loadHierarchy(dataset, manifest));
    if (json) {
        fmt::print("{}\n", toJson(manifest, hierarchy).dump(2));
    } else {
        print(manifest, hierarchy);
    }
    return {};
}

}  // namespace iwalk
