#include "preprocess/build/old_dataset.hpp"

#include <algorithm>

namespace iwalk {
namespace {

TriangleRecord triangleOf(const SourcePage& page, std::uint32_t firstIndex) {
    TriangleRecord record;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::uint16_t vertex = page.indices[firstIndex + corner];
        record.positions[corner] = page.positions[vertex];
        if (!page.colors.empty()) record.colors[corner] = page.colors[vertex];
        if (!page.normals.empty()) record.normals[corner] = page.normals[vertex];
    }
    return record;
}

Result<void> addRanges(const SourcePage& page, std::span<const Range> ranges,
                       const std::function<Result<void>(const TriangleRecord&)>& add) {
    for (const Range& range : ranges) {
        for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; i += 3) {
            const TriangleRecord record = triangleOf(page, i);
            const auto& [a, b, c] = record.positions;
            if (a == b || b == c || c == a) {
                return fail("a triangle of the dataset is none: the dataset is damaged; build it again");
            }
            RETURN_IF_ERROR(add(record));
        }
    }
    return {};
}

}  // namespace

Result<OldDataset> loadOldDataset(const std::string& path) {
    ASSIGN_OR_RETURN(Manifest manifest, loadManifest(path));
    ASSIGN_OR_RETURN(Hierarchy hierarchy, loadHierarchy(path, manifest));
    if (std::ranges::count(hierarchy.entries, 0u, &LevelRecord::pageCount) > 0) {
        return fail("{}: has entries without triangles, which this program does not make: build it again",
                    path);
    }
    LevelModel model = modelOf(hierarchy);
    return OldDataset{std::move(manifest), std::move(model), std::move(hierarchy.pages)};
}

bool fitsSparse(const OldDataset& old, unsigned rootCellLog2) {
    const unsigned before = old.model.lattice.rootCellLog2;
    if (rootCellLog2 <= kMostWholeLog2 || before < kCoarsestCellLog2) return true;
    // Other programs may have made it without levels.
    const auto hasLevels = [](const auto& entries) {
        return !entries.empty() && entries.back().level != kFullLevel;
    };
    return before > kMostWholeLog2 && std::ranges::any_of(old.model.entries, hasLevels);
}

LatticePoint middleOf(const LevelModel& model) {
    const Lattice& lattice = model.lattice;
    const unsigned depth = coarsestLevel(lattice.rootCellLog2);
    std::vector<std::uint64_t> triangles(model.nodes.size(), 0);
    std::size_t most = 0;
    for (std::size_t node = model.nodes.size(); node-- > 0;) {
        const NodeRecord& record = model.nodes[node];
        if (model.owns(static_cast<std::uint32_t>(node))) triangles[node] += model.entries[node][0].triangles;
        for (int child = 0; child < Hierarchy::childCount(record); ++child)
            triangles[node] += triangles[record.firstChild + static_cast<std::uint32_t>(child)];
        const bool isBetter = record.depth == depth && triangles[node] >= triangles[most];
        if (isBetter || model.nodes[most].depth != depth) most = node;
    }
    const CellPoint half(std::uint64_t{1} << (lattice.rootCellLog2 - depth - 1));
    return lattice.fromCell(model.cells()[most] + half);
}

std::vector<std::string> pagePaths(const std::string& dataset, const Manifest& manifest) {
    std::vector<std::string> paths;
    for (const DatasetFile& file : manifest.pageFiles) paths.push_back(dataset + "/" + file.name);
    return paths;
}

Result<void> readTouched(const OldDataset& old, const OldTree& tree, PageStore& store,
                         const std::function<Result<void>(const TriangleRecord&)>& add,
                         const std::function<void(double)>& done) {
    const LevelModel& model = old.model;
    for (std::uint32_t node = 0; node < model.nodes.size(); ++node) {
        done(static_cast<double>(node) / static_cast<double>(model.nodes.size()));
        if (!tree.isTouched(node) || !model.owns(node)) continue;
        const LevelRecord& entry = model.entries[node].front();
        for (std::uint32_t page = entry.firstPage; page < entry.firstPage + entry.pageCount; ++page) {
            ASSIGN_OR_RETURN(const std::shared_ptr<const SourcePage> source,
                             store.get(page, old.pages[page]));
            const std::span<const Range> all = source->ranges;
            const bool shared = entry.pageCount == 1;
            RETURN_IF_ERROR(
                addRanges(*source, shared ? all.subspan(entry.firstRange, entry.rangeCount) : all, add));
        }
    }
    return {};
}

}  // namespace iwalk
