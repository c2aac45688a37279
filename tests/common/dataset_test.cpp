#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include "common/dataset/hierarchy.hpp"
#include "common/dataset/manifest.hpp"
#include "common/dataset/page.hpp"
#include "common/file.hpp"
#include "tests/common/temp_directory.hpp"

namespace iwalk {
namespace {

void setBox(NodeRecord& node, std::int64_t low, std::int64_t high, bool own) {
    for (int axis = 0; axis < 3; ++axis) {
        node.boxMin[axis] = low, node.boxMax[axis] = high;
        node.ownMin[axis] = own ? low : LatticeBox{}.min.x;
        node.ownMax[axis] = own ? high : LatticeBox{}.max.x;
    }
}

// A root without triangles over three leaves: two share page 0, the third has pages 1 and 2.
Hierarchy makeHierarchy() {
    Hierarchy hierarchy;
    hierarchy.rootCell = LatticePoint(-100, -100, -100);
    hierarchy.rootCellLog2 = 9;
    hierarchy.nodes.resize(4);
    setBox(hierarchy.nodes[0], -90, 90, false);
    hierarchy.nodes[0].firstChild = 1;
    hierarchy.nodes[0].childMask = 0b10000011;
    setBox(hierarchy.nodes[1], -90, -20, true);
    setBox(hierarchy.nodes[2], -10, 10, true);
    setBox(hierarchy.nodes[3], 20, 90, true);
    for (std::size_t i = 1; i < 4; ++i) hierarchy.nodes[i].depth = 1;
    NodeRecord* nodes = hierarchy.nodes.data();
    nodes[1].triangles = 2, nodes[1].pageCount = 1, nodes[1].rangeCount = 1;
    nodes[2].triangles = 3, nodes[2].pageCount = 1, nodes[2].firstRange = 1, nodes[2].rangeCount = 2;
    nodes[3].triangles = 7, nodes[3].firstPage = 1, nodes[3].pageCount = 2;
    hierarchy.pages = {{0, 0, 500, 9, 15, 3, kPageColors},
                       {500, 0, 300, 8, 12, 2, kPageColors | kPageWide},
                       {800, 0, 200, 5, 9, 1, kPageColors}};
    return hierarchy;
}

Manifest makeManifest() {
    Manifest manifest;
    manifest.generation = 3;
    manifest.bounds = {glm::dvec3(-1.5, -0.1, 0), glm::dvec3(1, 2, 1e300)};
    manifest.stepExponent = -20;
    manifest.triangles = 12, manifest.vertices = 22;
    manifest.nodes = 4, manifest.leaves = 3, manifest.pages = 3;
    manifest.colors = true;
    manifest.hierarchy = {"hierarchy-3.bin", 64 + 4 * 128 + 3 * 32};
    manifest.pageFiles = {{"pages-3.bin", 1000}};
    manifest.provenance = {{"rack \"1\".ply", 12, 1, 2}};
    return manifest;
}

class DatasetTest : public testing::Test {
  protected:
    DatasetTest() {
        directory_.write("pages-3.bin", std::string(1000, 'p'));
        EXPECT_TRUE(saveHierarchy(directory_.path("hierarchy-3.bin"), makeHierarchy()).ok());
        EXPECT_TRUE(saveManifest(directory_.path(""), makeManifest()).ok());
    }

    // What loading says after `change` to the hierarchy: "" when it loads.
    std::string changed(const std::function<void(Hierarchy&)>& change) {
        Hierarchy hierarchy = makeHierarchy();
        change(hierarchy);
        EXPECT_TRUE(saveHierarchy(directory_.path("hierarchy-3.bin"), hierarchy).ok());
        const auto loaded = loadHierarchy(directory_.path(""), makeManifest());
        return loaded.ok() ? "" : loaded.error().message;
    }

    // What loading the manifest says with the value at the JSON pointer replaced, or removed.
    std::string manifestWith(const char* pointer, const nlohmann::json& value) {
        nlohmann::json json =
            nlohmann::json::parse(readWholeFile(directory_.path(kManifestName), 99999).value());
        json[nlohmann::json::json_pointer(pointer)] = value;
        directory_.write(kManifestName, json.dump());
        const auto loaded = loadManifest(directory_.path(""));
        EXPECT_TRUE(saveManifest(directory_.path(""), makeManifest()).ok());
        return loaded.ok() ? "" : loaded.error().message;
    }

    TempDirectory directory_;
};

TEST_F(DatasetTest, ManifestRoundTrips) {
    const auto loaded = loadManifest(directory_.path(""));
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    const Manifest wanted = makeManifest();
    EXPECT_EQ(loaded->generation, wanted.generation);
    EXPECT_EQ(loaded->bounds, wanted.bounds);
    EXPECT_EQ(loaded->stepExponent, wanted.stepExponent);
    EXPECT_EQ(loaded->triangles, wanted.triangles);
    EXPECT_EQ(loaded->vertices, wanted.vertices);
    EXPECT_EQ(loaded->leaves, wanted.leaves);
    EXPECT_TRUE(loaded->colors);
    EXPECT_FALSE(loaded->normals);
    EXPECT_EQ(loaded->hierarchy.name, wanted.hierarchy.name);
    EXPECT_EQ(loaded->pageFiles.at(0).bytes, 1000u);
    EXPECT_EQ(loaded->provenance.at(0).input, "rack \"1\".ply");
    EXPECT_EQ(loaded->provenance.at(0).droppedDegenerate, 2u);
}

TEST_F(DatasetTest, ManifestErrorsNameTheKey) {
    EXPECT_NE(manifestWith("/version", 7).find("dataset version 7, but this program reads version 0"),
              std::string::npos);
    EXPECT_NE(manifestWith("/format", "x").find("\"format\" must be"), std::string::npos);
    EXPECT_NE(manifestWith("/triangles", -1).find("\"triangles\" must be"), std::string::npos);
    EXPECT_NE(manifestWith("/triangles", 1.5).find("\"triangles\" must be"), std::string::npos);
    EXPECT_NE(manifestWith("/generation", 1e10).find("\"generation\""), std::string::npos);
    EXPECT_NE(manifestWith("/step_exponent", 5000).find("\"step_exponent\""), std::string::npos);
    EXPECT_NE(manifestWith("/bounds/min", {1, 2}).find("\"min\" must be three finite numbers"),
              std::string::npos);
    EXPECT_NE(manifestWith("/bounds/min", {1, 9, 2}).find("\"bounds\" must be a box"), std::string::npos);
    EXPECT_NE(manifestWith("/attributes/colors", "yes").find("\"colors\" must be true or false"),
              std::string::npos);
    EXPECT_NE(manifestWith("/attributes", nlohmann::json::object()).find("\"colors\" is missing"),
              std::string::npos);
    EXPECT_NE(manifestWith("/page_files", 3).find("\"page_files\" must be a list"), std::string::npos);
}

TEST_F(DatasetTest, ManifestNamesOnlyFilesOfItsDirectory) {
    for (const char* name : {"../pages-3.bin", "/etc/passwd", "", ".", "a/b"}) {
        EXPECT_NE(manifestWith("/hierarchy/name", name).find("plain file name"), std::string::npos) << name;
    }
    EXPECT_NE(manifestWith("/page_files/0/name", "pages-4.bin").find("pages-4.bin: missing"),
              std::string::npos);
    EXPECT_NE(manifestWith("/page_files/0/bytes", 999).find("1000 bytes where dataset.json says 999"),
              std::string::npos);
}

TEST_F(DatasetTest, ManifestTruncatedAnywhereIsRefused) {
    const std::string text = readWholeFile(directory_.path(kManifestName), 99999).value();
    for (std::size_t length = 0; length + 2 < text.size(); ++length) {
        directory_.write(kManifestName, text.substr(0, length));
        EXPECT_FALSE(loadManifest(directory_.path("")).ok()) << length;
    }
    EXPECT_NE(loadManifest("/nowhere").error().message.find("/nowhere/dataset.json"), std::string::npos);
}

TEST_F(DatasetTest, HierarchyRoundTrips) {
    const auto loaded = loadHierarchy(directory_.path(""), makeManifest());
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    const Hierarchy wanted = makeHierarchy();
    EXPECT_EQ(loaded->rootCell, wanted.rootCell);
    EXPECT_EQ(loaded->rootCellLog2, wanted.rootCellLog2);
    ASSERT_EQ(loaded->nodes.size(), wanted.nodes.size());
    EXPECT_EQ(std::memcmp(loaded->nodes.data(), wanted.nodes.data(), 4 * sizeof(NodeRecord)), 0);
    ASSERT_EQ(loaded->pages.size(), wanted.pages.size());
    EXPECT_EQ(std::memcmp(loaded->pages.data(), wanted.pages.data(), 3 * sizeof(PageRecord)), 0);
    EXPECT_EQ(Hierarchy::childCount(loaded->nodes[0]), 3);
}

TEST_F(DatasetTest, HierarchyGoldenHeader) {
    const std::string bytes = readWholeFile(directory_.path("hierarchy-3.bin"), 99999).value();
    ASSERT_EQ(bytes.size(), makeManifest().hierarchy.bytes);
    const unsigned char golden[48] = {'I',  'W',  'H',  'S',  0,    0,    0,    0,    4,    3,    2,    1,
                                      9,    0,    0,    0,    0x9c, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,
                                      0x9c, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x9c, 0xff, 0xff, 0xff,
                                      0xff, 0xff, 0xff, 0xff, 4,    0,    0,    0,    3,    0,    0,    0};
    EXPECT_EQ(std::memcmp(bytes.data(), golden, sizeof(golden)), 0);
}

TEST_F(DatasetTest, HierarchyTruncatedOrFlippedAnywhereIsRefused) {
    const std::string good = readWholeFile(directory_.path("hierarchy-3.bin"), 99999).value();
    for (std::size_t length = 0; length < good.size(); ++length) {
        directory_.write("hierarchy-3.bin", good.substr(0, length));
        EXPECT_FALSE(loadHierarchy(directory_.path(""), makeManifest()).ok()) << length;
    }
    for (std::size_t at = 0; at < good.size(); ++at) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ 0x04);
        directory_.write("hierarchy-3.bin", bad);
        EXPECT_FALSE(loadHierarchy(directory_.path(""), makeManifest()).ok()) << at;
    }
}

TEST_F(DatasetTest, HierarchyOfAnotherVersionSaysWhich) {
    std::string bytes = readWholeFile(directory_.path("hierarchy-3.bin"), 99999).value();
    bytes[4] = 9;
    directory_.write("hierarchy-3.bin", bytes);
    EXPECT_NE(loadHierarchy(directory_.path(""), makeManifest())
                  .error()
                  .message.find("version 9, but this program reads version 0"),
              std::string::npos);
}

// Right checksums over wrong records.
TEST_F(DatasetTest, HierarchyNodesAreChecked) {
    EXPECT_EQ(changed([](Hierarchy&) {}), "");
    const auto refused = [&](const char* why, const std::function<void(Hierarchy&)>& change) {
        const std::string message = changed(change);
        EXPECT_NE(message.find(why), std::string::npos) << why << ": " << message;
    };
    refused("no nodes", [](Hierarchy& h) { h.nodes.clear(); });
    refused("root cell", [](Hierarchy& h) { h.rootCellLog2 = 62; });
    refused("root cell", [](Hierarchy& h) { h.rootCell.x = kLatticeLimit + 1; });
    refused("node 0", [](Hierarchy& h) { h.nodes[0].firstChild = 0; });
    refused("node 0", [](Hierarchy& h) { h.nodes[0].firstChild = 2; });
    refused("node 0", [](Hierarchy& h) { h.nodes[0].firstChild = 0xffffffff; });
    refused("no parent", [](Hierarchy& h) {
        h.nodes[0].childMask = 3;
        h.nodes[0].boxMax[0] = 10;
        h.nodes[0].boxMax[1] = 10;
        h.nodes[0].boxMax[2] = 10;
    });
    refused("leaf with children", [](Hierarchy& h) { h.nodes[1].firstChild = 3; });
    refused("depth", [](Hierarchy& h) { h.nodes[2].depth = 2; });
    refused("depth", [](Hierarchy& h) { h.nodes[2].depth = 200; });
    refused("box is not that", [](Hierarchy& h) { h.nodes[0].boxMax[1] = 91; });
    refused("box out of bounds", [](Hierarchy& h) { h.nodes[3].ownMax[1] = INT64_MAX; });
    refused("box out of bounds", [](Hierarchy& h) { h.nodes[3].boxMin[1] = INT64_MIN; });
    refused("owns nothing", [](Hierarchy& h) { h.nodes[0].ownMin[0] = 0; });
    refused("triangles without pages", [](Hierarchy& h) { h.nodes[0].triangles = 1; });
    refused("reserved", [](Hierarchy& h) { h.nodes[0].reserved[5] = 1; });
    refused("pages from", [](Hierarchy& h) { h.nodes[3].pageCount = 3; });
    refused("pages from", [](Hierarchy& h) { h.nodes[3].firstPage = 0xffffffff; });
    refused("ranges from", [](Hierarchy& h) { h.nodes[2].rangeCount = 65535; });
    refused("several pages", [](Hierarchy& h) { h.nodes[3].rangeCount = 1; });
    refused("two nodes or none", [](Hierarchy& h) {
        h.nodes[2].firstRange = 0;
        h.nodes[2].rangeCount = 3;
    });
    refused("belongs to no node", [](Hierarchy& h) { h.nodes[2].rangeCount = 1; });
    refused("do not add up", [](Hierarchy& h) { h.nodes[2].triangles = 4; });
    refused("too many triangles", [](Hierarchy& h) { h.nodes[2].triangles = UINT64_MAX; });
    refused("its pages 7", [](Hierarchy& h) { h.nodes[3].triangles = 8; });
}

TEST_F(DatasetTest, HierarchyPagesAreChecked) {
    const auto refused = [&](const char* why, const std::function<void(PageRecord&)>& change) {
        const std::string message = changed([&](Hierarchy& h) { change(h.pages[1]); });
        EXPECT_NE(message.find("page record 1"), std::string::npos) << why << ": " << message;
        EXPECT_NE(message.find(why), std::string::npos) << why << ": " << message;
    };
    refused("file that is not there", [](PageRecord& p) { p.file = 1; });
    refused("beyond the end", [](PageRecord& p) { p.offset = 701; });
    refused("beyond the end", [](PageRecord& p) { p.offset = UINT64_MAX - 10; });
    refused("attributes", [](PageRecord& p) { p.flags = kPageNormals; });
    refused("impossible", [](PageRecord& p) { p.flags = 64; });
    refused("impossible", [](PageRecord& p) { p.vertexCount = 70000; });
    refused("impossible", [](PageRecord& p) { p.indexCount = 0xfffffffd; });
    refused("impossible", [](PageRecord& p) { p.rangeCount = 0x80000000; });
}

TEST_F(DatasetTest, HierarchyTotalsMustBeTheManifests) {
    Manifest manifest = makeManifest();
    manifest.triangles = 13;
    EXPECT_FALSE(loadHierarchy(directory_.path(""), manifest).ok());
    manifest = makeManifest(), manifest.vertices = 21;
    EXPECT_FALSE(loadHierarchy(directory_.path(""), manifest).ok());
    manifest = makeManifest(), manifest.leaves = 2;
    EXPECT_FALSE(loadHierarchy(directory_.path(""), manifest).ok());
}

}  // namespace
}  // namespace iwalk
