#include "tests/tools/levels/tube_dataset.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/check.hpp"
#include "common/dataset/level_summary.hpp"
#include "common/dataset/manifest.hpp"
#include "common/dataset/morph.hpp"
#include "common/dataset/page.hpp"
#include "common/file.hpp"

namespace iwalk::levels {
namespace {

constexpr unsigned kRootLog2 = 12;
const LatticePoint kRootCell{-1000, 500, 7};

// Segments whose triangles have their centroid in cell `cell` of a depth, counted along x.
std::vector<int> segmentsIn(std::int64_t cell, unsigned depth) {
    std::vector<int> segments;
    for (int s = 0; s < kSegments; ++s) {
        if (ringX(s) >> (kRootLog2 - depth) == cell) segments.push_back(s);
    }
    return segments;
}

// Around the triangles of a cell at all levels.
LatticeBox cellBox(std::int64_t cell, unsigned depth) {
    LatticeBox box;
    for (const int segment : segmentsIn(cell, depth)) {
        for (const TubeTriangle& triangle : tubeTriangles(segment)) {
            for (const RingCorner& corner : triangle) {
                for (int level = 0; level <= kInput; ++level) box.add(kRootCell + tubePoint(corner, level));
            }
        }
    }
    return box;
}

// The way from a node's cell to the cell of a depth along x.
std::uint32_t pathTo(std::int64_t cell, unsigned depth, unsigned nodeDepth) {
    std::uint32_t path = kRootPath;
    for (unsigned level = depth; level-- > nodeDepth;)
        path = path << 3 | static_cast<std::uint32_t>(cell >> (level - nodeDepth) & 1);
    return path;
}

// A page of one entry.
class PageMaker {
  public:
    PageMaker(std::int64_t nodeCell, unsigned nodeDepth, int level, unsigned cellDepth) : level_(level) {
        page_.origin = cellBox(nodeCell, nodeDepth).min;
        const std::int64_t cells = std::int64_t{1} << (cellDepth - nodeDepth);
        for (std::int64_t cell = nodeCell * cells; cell < (nodeCell + 1) * cells; ++cell)
            addRange(cell, cellDepth, pathTo(cell - nodeCell * cells, cellDepth - nodeDepth, 0));
    }
    const PageGeometry& page() const { return page_; }
    const std::vector<LatticePoint>& targets() const { return targets_; }

  private:
    void addRange(std::int64_t cell, unsigned depth, std::uint32_t path) {
        Range range{static_cast<std::uint32_t>(page_.indices.size()), 0, path, {}, {}};
        for (const int segment : segmentsIn(cell, depth)) {
            for (const TubeTriangle& triangle : tubeTriangles(segment)) {
                if (isGone(triangle, level_)) continue;
                for (const RingCorner& corner : triangle) page_.indices.push_back(vertex(corner));
            }
        }
        range.indexCount = static_cast<std::uint32_t>(page_.indices.size()) - range.firstIndex;
        if (range.indexCount == 0) return;
        const LatticeBox box = cellBox(cell, depth);
        for (int axis = 0; axis < 3; ++axis) {
            range.boxMin[axis] = static_cast<std::uint32_t>(box.min[axis] - page_.origin[axis]);
            range.boxMax[axis] = static_cast<std::uint32_t>(box.max[axis] - page_.origin[axis]);
        }
        page_.ranges.push_back(range);
    }

    std::uint16_t vertex(const RingCorner& corner) {
        const LatticePoint p = kRootCell + tubePoint(corner, level_);
        const auto next = static_cast<std::uint16_t>(page_.vertices.size());
        const auto [found, added] = numbers_.try_emplace({p.x, p.y, p.z}, next);
        if (added) {
            const LatticePoint offset = p - page_.origin;
            PageVertex made{};
            for (int axis = 0; axis < 3; ++axis) made.offset[axis] = static_cast<std::uint32_t>(offset[axis]);
            page_.vertices.push_back(made);
            targets_.push_back(kRootCell + tubePoint(corner, std::max(level_ - 1, 0)));
        }
        return found->second;
    }

    int level_;
    PageGeometry page_;
    std::vector<LatticePoint> targets_;
    std::map<std::array<std::int64_t, 3>, std::uint16_t> numbers_;
};

class Writer {
  public:
    explicit Writer(const std::string& dataset) : dataset_(dataset) {
        hierarchy_.rootCell = kRootCell, hierarchy_.rootCellLog2 = kRootLog2;
        addNode(0, 0, false);
        addEntry(PageMaker(0, 0, 0, 2), 0);
        hierarchy_.nodes[0].firstChild = 1, hierarchy_.nodes[0].childMask = 0b11;
        for (const std::int64_t cell : {0, 1}) {
            addNode(cell, 1, true);
            addEntry(PageMaker(cell, 1, 1, 3), 1);
            addEntry(PageMaker(cell, 1, kInput, 4), kFullLevel);
        }
    }

    void write() {
        auto file = OutputFile::create(dataset_ + "/pages-1.bin");
        CHECK(file.ok() && file->write(bytes_).ok() && file->sync().ok());
        const auto bytes = saveHierarchy(dataset_ + "/hierarchy-1.bin", hierarchy_);
        CHECK(bytes.ok());
        Manifest manifest;
        manifest.bounds = {glm::dvec3(-500, 250, 3.5), glm::dvec3(1548, 260, 10)};
        manifest.stepExponent = -1;
        const LevelSummaries levels = summariseLevels(hierarchy_, manifest.stepExponent);
        manifest.levels = levels.levels, manifest.full = levels.full;
        manifest.triangles = levels.full.triangles;
        for (const PageRecord& page : hierarchy_.pages) manifest.vertices += page.vertexCount;
        manifest.nodes = 3, manifest.leaves = 2, manifest.pages = hierarchy_.pages.size();
        manifest.leafTriangles = 1024;
        manifest.hierarchy = {"hierarchy-1.bin", *bytes};
        manifest.pageFiles = {{"pages-1.bin", bytes_.size()}};
        CHECK(saveManifest(dataset_, manifest).ok());
    }

  private:
    void addNode(std::int64_t cell, unsigned depth, bool owns) {
        NodeRecord node{};
        const LatticeBox box = cellBox(cell, depth), own = owns ? box : LatticeBox{};
        for (int axis = 0; axis < 3; ++axis) {
            node.boxMin[axis] = box.min[axis], node.boxMax[axis] = box.max[axis];
            node.ownMin[axis] = own.min[axis], node.ownMax[axis] = own.max[axis];
        }
        node.depth = static_cast<std::uint8_t>(depth);
        node.firstEntry = static_cast<std::uint32_t>(hierarchy_.entries.size());
        hierarchy_.nodes.push_back(node);
    }

    void addEntry(const PageMaker& maker, std::uint8_t level) {
        PageRecord record{};
        const std::vector<std::byte> bytes = encodePage(maker.page(), record);
        record.offset = bytes_.size();
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        if (level > 0) {
            const PageGeometry& page = maker.page();
            std::vector<LatticePoint> positions;
            for (const PageVertex& v : page.vertices) {
                positions.push_back(page.origin + LatticePoint(v.offset[0], v.offset[1], v.offset[2]));
            }
            const auto morph =
                encodeMorph({page.origin, positions, maker.targets(), page.ranges, page.indices}, record);
            record.morphOffset = bytes_.size();
            bytes_.insert(bytes_.end(), morph.begin(), morph.end());
        }
        LevelRecord entry{};
        entry.firstPage = static_cast<std::uint32_t>(hierarchy_.pages.size()), entry.pageCount = 1;
        entry.triangles = record.indexCount / 3, entry.vertices = record.vertexCount;
        entry.rangeCount = static_cast<std::uint16_t>(record.rangeCount), entry.level = level;
        entry.error = level == kFullLevel ? 0.0f : static_cast<float>(levelErrorSteps(kRootLog2, level));
        hierarchy_.entries.push_back(entry);
        hierarchy_.pages.push_back(record);
        ++hierarchy_.nodes.back().entryCount;
    }

    std::string dataset_;
    Hierarchy hierarchy_;
    std::vector<std::byte> bytes_;
};

}  // namespace

void writeTube(const std::string& dataset) {
    Writer(dataset).write();
}

}  // namespace iwalk::levels
