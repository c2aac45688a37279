#include "tests/common/dataset_fixture.hpp"

namespace iwalk {
namespace {

NodeRecord makeNode(unsigned depth, std::int64_t low, std::int64_t high, std::uint32_t firstEntry,
                    std::uint8_t entries) {
    NodeRecord node{};
    for (int axis = 0; axis < 3; ++axis) {
        node.boxMin[axis] = node.ownMin[axis] = low;
        node.boxMax[axis] = node.ownMax[axis] = high;
    }
    node.depth = static_cast<std::uint8_t>(depth);
    node.firstEntry = firstEntry;
    node.entryCount = entries;
    return node;
}

LevelRecord makeEntry(std::uint8_t level, float error, std::uint32_t page, std::uint16_t firstRange,
                      std::uint16_t ranges, std::uint32_t triangles, std::uint32_t vertices) {
    LevelRecord entry{};
    entry.level = level, entry.error = error;
    entry.firstPage = page, entry.pageCount = ranges > 0 ? 1 : 2;
    entry.firstRange = firstRange, entry.rangeCount = ranges;
    entry.triangles = triangles, entry.vertices = vertices;
    return entry;
}

// Appends a page, and its morph block behind those before.
void addPage(Hierarchy& hierarchy, std::uint32_t bytes, std::uint32_t morphBytes, std::uint32_t vertices,
             std::uint32_t triangles, std::uint32_t ranges, std::uint32_t flags) {
    PageRecord page{};
    for (const PageRecord& before : hierarchy.pages) {
        page.offset += before.bytes;
        if (morphBytes > 0) page.morphOffset += before.morphBytes;
    }
    page.bytes = bytes, page.morphBytes = morphBytes;
    page.morphFile = morphBytes > 0 ? 1 : 0;
    page.vertexCount = vertices, page.indexCount = 3 * triangles, page.rangeCount = ranges;
    page.flags = flags;
    hierarchy.pages.push_back(page);
}

}  // namespace

Hierarchy makeHierarchy() {
    Hierarchy hierarchy;
    hierarchy.rootCell = LatticePoint(-100, -100, -100);
    hierarchy.rootCellLog2 = 9;  // e_0 is 4 steps
    hierarchy.nodes = {makeNode(0, -90, 95, 0, 3), makeNode(1, -90, -20, 3, 2), makeNode(1, -10, 10, 5, 1),
                       makeNode(1, 20, 90, 6, 3)};
    NodeRecord& root = hierarchy.nodes[0];
    root.firstChild = 1, root.childMask = 0b10000011;
    for (int axis = 0; axis < 3; ++axis) root.ownMin[axis] = -80, root.ownMax[axis] = 70;
    for (std::uint8_t i = 0; i < kOpacityDirections; ++i) hierarchy.nodes[3].opacity[i] = i;
    hierarchy.entries = {makeEntry(0, 3.5f, 0, 0, 2, 4, 6),       makeEntry(1, 2.0f, 1, 0, 1, 2, 4),
                         makeEntry(kFullLevel, 0, 3, 0, 1, 3, 5), makeEntry(1, 1.5f, 1, 1, 1, 3, 5),
                         makeEntry(kFullLevel, 0, 3, 1, 1, 5, 7), makeEntry(kFullLevel, 0, 4, 0, 1, 2, 4),
                         makeEntry(1, 2.0f, 1, 2, 2, 4, 6),       makeEntry(2, 0.75f, 2, 0, 1, 6, 7),
                         makeEntry(kFullLevel, 0, 5, 0, 0, 7, 13)};
    addPage(hierarchy, 500, 0, 6, 4, 2, kPageColors);
    addPage(hierarchy, 400, 116, 14, 9, 4, kPageColors);
    addPage(hierarchy, 300, 106, 7, 6, 1, kPageColors | kMorphWide);
    addPage(hierarchy, 600, 136, 11, 8, 2, kPageColors | kPageWide);
    addPage(hierarchy, 200, 104, 4, 2, 1, kPageColors);
    addPage(hierarchy, 250, 111, 8, 4, 2, kPageColors);
    addPage(hierarchy, 150, 107, 5, 3, 1, kPageColors);
    return hierarchy;
}

Manifest makeManifest() {
    Manifest manifest;
    manifest.generation = 3;
    manifest.bounds = {glm::dvec3(-1.5, -0.1, 0), glm::dvec3(1, 2, 1e300)};
    manifest.stepExponent = -20;
    manifest.triangles = 17, manifest.vertices = 55;
    manifest.nodes = 4, manifest.leaves = 3, manifest.pages = 7;
    manifest.leafTriangles = 16;
    manifest.levels = {{0x1p-17, 4, 500}, {0x1p-18, 11, 516}, {0x1p-19, 16, 406}};
    manifest.full = {0, 17, 1658};
    manifest.colors = true;
    manifest.hierarchy = {"hierarchy-3.bin", 72 + 4 * 128 + 9 * 32 + 7 * 48};
    manifest.pageFiles = {{"pages-3.bin", 2400}, {"morphs-3.bin", 696}};
    manifest.provenance = {{"rack \"1\".ply", 17, 1, 2}};
    return manifest;
}

DatasetTest::DatasetTest() {
    directory_.write("pages-3.bin", std::string(2400, 'p'));
    directory_.write("morphs-3.bin", std::string(696, 'm'));
    EXPECT_TRUE(saveHierarchy(directory_.path("hierarchy-3.bin"), makeHierarchy()).ok());
    EXPECT_TRUE(saveManifest(directory_.path(""), makeManifest()).ok());
}

}  // namespace iwalk
