#include "common/dataset/hierarchy.hpp"

#include <array>
#include <cstring>
#include <functional>
#include <random>

#include "common/dataset/hierarchy_check.hpp"
#include "common/dataset/level_summary.hpp"
#include "common/dataset/page.hpp"
#include "common/file.hpp"
#include "tests/common/dataset_fixture.hpp"

namespace iwalk {
namespace {

using Change = std::function<void(Hierarchy&)>;

class HierarchyTest : public DatasetTest {
  protected:
    // What loading says after `change`: "" when it loads.
    std::string changed(const Change& change) {
        Hierarchy hierarchy = makeHierarchy();
        change(hierarchy);
        EXPECT_TRUE(saveHierarchy(directory_.path("hierarchy-3.bin"), hierarchy).ok());
        const auto loaded = loadHierarchy(directory_.path(""), makeManifest());
        return loaded.ok() ? "" : loaded.error().message;
    }
    // It must name the record and say why.
    void refused(const char* record, const char* why, const Change& change) {
        const std::string message = changed(change);
        EXPECT_NE(message.find(record), std::string::npos) << record << " " << why << ": " << message;
        EXPECT_NE(message.find(why), std::string::npos) << record << " " << why << ": " << message;
    }
};

template <class Record>
bool same(const std::vector<Record>& a, const std::vector<Record>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Record)) == 0;
}

TEST_F(HierarchyTest, RoundTrips) {
    const auto loaded = loadHierarchy(directory_.path(""), makeManifest());
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    const Hierarchy wanted = makeHierarchy();
    EXPECT_EQ(loaded->rootCell, wanted.rootCell);
    EXPECT_EQ(loaded->rootCellLog2, wanted.rootCellLog2);
    EXPECT_TRUE(same(loaded->nodes, wanted.nodes));
    EXPECT_TRUE(same(loaded->entries, wanted.entries));
    EXPECT_TRUE(same(loaded->pages, wanted.pages));
    EXPECT_EQ(Hierarchy::childCount(loaded->nodes[0]), 3);
    EXPECT_EQ(readWholeFile(directory_.path("hierarchy-3.bin"), 99999).value().size(),
              makeManifest().hierarchy.bytes);
}

TEST_F(HierarchyTest, EntriesAreFound) {
    const Hierarchy hierarchy = makeHierarchy();
    const NodeRecord &root = hierarchy.nodes[0], &leaf = hierarchy.nodes[3];
    const auto index = [&](const LevelRecord* entry) {
        return entry != nullptr ? entry - hierarchy.entries.data() : -1;
    };
    EXPECT_TRUE(hierarchy.hasLevels());
    EXPECT_EQ(hierarchy.entriesOf(leaf).size(), 3u);
    EXPECT_EQ(index(hierarchy.entryAt(leaf, 2)), 7);
    EXPECT_EQ(index(hierarchy.entryAt(leaf, 0)), -1);
    EXPECT_EQ(index(hierarchy.fullEntryOf(root)), 2);
    EXPECT_EQ(hierarchy.ownTriangles(root), 3u);
    EXPECT_TRUE(Hierarchy::isWhole(root, hierarchy.entries[0]));
    EXPECT_FALSE(Hierarchy::isWhole(root, hierarchy.entries[1]));
    EXPECT_FALSE(Hierarchy::isWhole(hierarchy.nodes[1], hierarchy.entries[3]));
    EXPECT_EQ(Hierarchy::entryBox(root, hierarchy.entries[0]), Hierarchy::box(root));
    EXPECT_EQ(Hierarchy::entryBox(root, hierarchy.entries[2]), Hierarchy::ownBox(root));
    EXPECT_EQ(levelErrorSteps(9, 0), 8);
    EXPECT_EQ(levelErrorSteps(9, 3), 1);
}

// By level, the entry that each node adds to the whole model.
TEST_F(HierarchyTest, TheWholeModelAtALevel) {
    const Hierarchy hierarchy = makeHierarchy();
    const auto drawn = [&](unsigned level) {
        std::vector<std::ptrdiff_t> entries;
        for (const NodeRecord& node : hierarchy.nodes) {
            const LevelRecord* entry = hierarchy.drawnAt(node, level);
            entries.push_back(entry != nullptr ? entry - hierarchy.entries.data() : -1);
        }
        return entries;
    };
    using Entries = std::vector<std::ptrdiff_t>;
    EXPECT_EQ(drawn(0), (Entries{0, -1, -1, -1}));
    EXPECT_EQ(drawn(1), (Entries{1, 3, 5, 6}));
    EXPECT_EQ(drawn(2), (Entries{2, 4, 5, 7}));
    EXPECT_EQ(drawn(3), (Entries{2, 4, 5, 8}));
    EXPECT_EQ(drawn(kFullLevel), (Entries{2, 4, 5, 8}));
    EXPECT_EQ(summariseLevels(hierarchy, -20), (LevelSummaries{makeManifest().levels, makeManifest().full}));
}

TEST_F(HierarchyTest, TruncatedOrFlippedAnywhereIsRefused) {
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

TEST_F(HierarchyTest, AnotherVersionSaysWhich) {
    std::string bytes = readWholeFile(directory_.path("hierarchy-3.bin"), 99999).value();
    bytes[4] = 9;
    directory_.write("hierarchy-3.bin", bytes);
    EXPECT_NE(loadHierarchy(directory_.path(""), makeManifest())
                  .error()
                  .message.find("version 9, but this program reads version 1"),
              std::string::npos);
}

// Right checksums over wrong records.
TEST_F(HierarchyTest, NodesAreChecked) {
    EXPECT_EQ(changed([](Hierarchy&) {}), "");
    refused("", "no nodes", [](Hierarchy& h) { h.nodes.clear(); });
    refused("", "root cell", [](Hierarchy& h) { h.rootCellLog2 = 62; });
    refused("", "root cell", [](Hierarchy& h) { h.rootCell.x = kLatticeLimit + 1; });
    for (const std::uint32_t first : {0u, 2u, 0xffffffffu}) {
        refused("node 0", "children from", [&](Hierarchy& h) { h.nodes[0].firstChild = first; });
    }
    refused("node 0", "children from 1 on, 8 of them, of 4",
            [](Hierarchy& h) { h.nodes[0].childMask = 0xff; });
    refused("node 3", "no parent", [](Hierarchy& h) { h.nodes[0].childMask = 3; });
    refused("node 1", "leaf with children", [](Hierarchy& h) { h.nodes[1].firstChild = 3; });
    refused("node 2", "depth", [](Hierarchy& h) { h.nodes[2].depth = 2; });
    refused("node 2", "depth", [](Hierarchy& h) { h.nodes[2].depth = 200; });
    refused("node 3", "box reaches out of its parent's", [](Hierarchy& h) { h.nodes[3].boxMax[1] = 96; });
    refused("node 0", "own box reaches out", [](Hierarchy& h) { h.nodes[0].ownMin[1] = -91; });
    refused("node 3", "own box out of bounds", [](Hierarchy& h) { h.nodes[3].ownMax[1] = INT64_MAX; });
    refused("node 3", "box out of bounds", [](Hierarchy& h) { h.nodes[3].boxMin[1] = INT64_MIN; });
    refused("node 0", "reserved", [](Hierarchy& h) { h.nodes[0].reserved = 1; });
    refused("node 0", "opacities", [](Hierarchy& h) { h.nodes[0].opacity[19] = 1; });
}

TEST_F(HierarchyTest, RunsOfEntriesAreChecked) {
    refused("node 1", "entries from", [](Hierarchy& h) { h.nodes[1].firstEntry = 2; });
    refused("node 2", "entries from", [](Hierarchy& h) { h.nodes[1].entryCount = 1; });
    refused("node 3", "entries from", [](Hierarchy& h) { h.nodes[3].entryCount = 4; });
    refused("node 3", "entries from", [](Hierarchy& h) { h.nodes[3].firstEntry = 0xffffffff; });
    refused("", "10 level records, of which nodes have 9",
            [](Hierarchy& h) { h.entries.push_back(h.entries.back()); });
    refused("node 2", "empty leaf", [](Hierarchy& h) {
        h.nodes[2].entryCount = 0, h.nodes[3].firstEntry = 5;
        h.entries.erase(h.entries.begin() + 5);
    });
}

TEST_F(HierarchyTest, LevelsAreChecked) {
    refused("node 0", "does not have level 0 first", [](Hierarchy& h) { h.entries[0].level = 1; });
    refused("node 1", "has level 2 where 1", [](Hierarchy& h) { h.entries[3].level = 2; });
    refused("node 3", "has level 3 where 2", [](Hierarchy& h) { h.entries[7].level = 3; });
    refused("node 3", "has level 255 where 2", [](Hierarchy& h) { h.entries[7].level = kFullLevel; });
    refused("node 3", "never at full", [](Hierarchy& h) { h.entries[8].level = 3; });
    refused("node 3", "error grows", [](Hierarchy& h) { h.entries[6].error = 0.5f; });
    refused("node 0", "own triangles without a box", [](Hierarchy& h) {
        for (int axis = 0; axis < 3; ++axis) {
            h.nodes[0].ownMin[axis] = LatticeBox{}.min.x, h.nodes[0].ownMax[axis] = LatticeBox{}.max.x;
        }
    });
    // A node's first entry being full says that no node has levels.
    refused("level record 1", "where the first entry is full", [](Hierarchy& h) {
        h.nodes[0].entryCount = 1;
        for (std::size_t n = 1; n < 4; ++n) h.nodes[n].firstEntry -= 2;
        h.entries.erase(h.entries.begin(), h.entries.begin() + 2);
        h.entries.insert(h.entries.begin() + 1, h.entries[1]);
        ++h.nodes[1].entryCount;
        h.nodes[2].firstEntry++, h.nodes[3].firstEntry++;
        h.entries[1].level = 1, h.entries[2].level = 2, h.entries[3].level = kFullLevel;
    });
}

TEST_F(HierarchyTest, EntriesAreChecked) {
    refused("level record 8", "error", [](Hierarchy& h) { h.entries[8].error = 0.1f; });
    refused("level record 0", "error", [](Hierarchy& h) { h.entries[0].error = 8.1f; });
    refused("level record 7", "error",
            [](Hierarchy& h) { h.entries[7].error = -1, h.entries[8].error = -2; });
    refused("level record 0", "error",
            [](Hierarchy& h) { h.entries[0].error = std::numeric_limits<float>::quiet_NaN(); });
    refused("level record 4", "reserved", [](Hierarchy& h) { h.entries[4].reserved[6] = 1; });
    refused("level record 8", "missing", [](Hierarchy& h) { h.entries[8].triangles = 0; });
    refused("level record 7", "missing", [](Hierarchy& h) { h.entries[7].pageCount = 0; });
    refused("level record 7", "not blank", [](Hierarchy& h) { h.entries[7].triangles = 0; });
    refused("level record 7", "vertices", [](Hierarchy& h) { h.entries[7].vertices = 19; });
    refused("level record 7", "vertices", [](Hierarchy& h) { h.entries[7].vertices = 0; });
    refused("level record 8", "pages from", [](Hierarchy& h) { h.entries[8].pageCount = 3; });
    refused("level record 8", "pages from", [](Hierarchy& h) { h.entries[8].firstPage = 0xffffffff; });
    refused("level record 6", "ranges from", [](Hierarchy& h) { h.entries[6].rangeCount = 65535; });
    refused("level record 8", "several pages", [](Hierarchy& h) { h.entries[8].rangeCount = 1; });
    refused("level record 8", "its pages 7 and 13", [](Hierarchy& h) { h.entries[8].triangles = 8; });
}

TEST_F(HierarchyTest, SharesOfPagesAreChecked) {
    refused("page record 1", "two entries or none", [](Hierarchy& h) { h.entries[6].firstRange = 1; });
    refused("page record 1", "belongs to no entry", [](Hierarchy& h) { h.entries[6].rangeCount = 1; });
    refused("page record 1", "triangles do not add up", [](Hierarchy& h) { h.entries[6].triangles = 5; });
    refused("page record 1", "triangles do not add up",
            [](Hierarchy& h) { h.entries[6].triangles = 0xffffffff; });
    refused("page record 1", "vertices do not add up", [](Hierarchy& h) { h.pages[1].vertexCount = 16; });
    refused("page record 1", "more vertices than there are",
            [](Hierarchy& h) { h.entries[6].vertices = 12, h.pages[1].vertexCount = 5; });
    refused("page record 4", "belongs to no entry", [](Hierarchy& h) { h.entries[5].firstPage = 5; });
    refused("page record 4", "two entries or none", [](Hierarchy& h) { h.entries[8].firstPage = 4; });
    refused("page record 1", "of two levels", [](Hierarchy& h) {
        std::swap(h.entries[3].firstPage, h.entries[4].firstPage);  // full among level 1
        std::swap(h.entries[3].triangles, h.entries[4].triangles);
        h.pages[1].indexCount += 6, h.pages[3].indexCount -= 6;
    });
    refused("page record 0", "morph block", [](Hierarchy& h) { h.pages[0].morphBytes = 104; });
    // Full of leaf 2 turns into level 0, that of leaf 1 into level 1.
    refused("page record 3", "morph block is of two levels", [](Hierarchy& h) {
        h.entries[5].firstPage = 3, h.entries[5].firstRange = 2;
        h.pages[3].rangeCount = 3, h.pages[3].indexCount += 6;
        h.pages.erase(h.pages.begin() + 4);
        --h.entries[8].firstPage;
    });
}

// What became of nothing but points at a coarse level has no pages there.
TEST_F(HierarchyTest, CoarseEntriesMayBeEmpty) {
    const std::string message = changed([](Hierarchy& h) {
        h.entries[3] = {0, 0, 0, 0, 1.5f, 0, 0, 1, {}};
        h.entries[6].firstRange = 1;
        h.pages[1].rangeCount = 3, h.pages[1].indexCount = 18, h.pages[1].vertexCount = 10;
    });
    EXPECT_NE(message.find("counts are not those of dataset.json"), std::string::npos) << message;
}

// As builders without levels make them: interior nodes have their own triangles or nothing.
TEST_F(HierarchyTest, DatasetsMayHaveNoLevels) {
    Hierarchy hierarchy = makeHierarchy();
    std::vector<LevelRecord> full;
    for (NodeRecord& node : hierarchy.nodes) {
        LevelRecord entry = *hierarchy.fullEntryOf(node);
        entry.firstPage -= 3;
        node.firstEntry = static_cast<std::uint32_t>(full.size()), node.entryCount = 1;
        full.push_back(entry);
    }
    hierarchy.entries = full;
    hierarchy.pages.erase(hierarchy.pages.begin(), hierarchy.pages.begin() + 3);
    for (PageRecord& page : hierarchy.pages) page.morphOffset = page.morphBytes = page.morphFile = 0;
    Manifest manifest = makeManifest();
    manifest.levels.clear(), manifest.full.bytes = 1200;
    manifest.vertices = 28, manifest.pages = 4;
    EXPECT_TRUE(saveHierarchy(directory_.path("hierarchy-3.bin"), hierarchy).ok());
    const auto loaded = loadHierarchy(directory_.path(""), manifest);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    EXPECT_FALSE(loaded->hasLevels());
    for (const NodeRecord& node : loaded->nodes)
        EXPECT_EQ(loaded->drawnAt(node, 0), loaded->fullEntryOf(node));
}

TEST_F(HierarchyTest, PagesAreChecked) {
    const auto bad = [&](const char* why, const std::function<void(PageRecord&)>& change) {
        refused("page record 1", why, [&](Hierarchy& h) { change(h.pages[1]); });
    };
    bad("file that is not there", [](PageRecord& p) { p.file = 2; });
    bad("beyond the end", [](PageRecord& p) { p.offset = 2001; });
    bad("beyond the end", [](PageRecord& p) { p.offset = UINT64_MAX - 10; });
    bad("file that is not there", [](PageRecord& p) { p.morphFile = 2; });
    bad("beyond the end", [](PageRecord& p) { p.morphOffset = 581; });
    bad("beyond the end", [](PageRecord& p) { p.morphOffset = UINT64_MAX - 10; });
    bad("impossible morph", [](PageRecord& p) { p.morphBytes = 103; });
    bad("impossible morph", [](PageRecord& p) { p.morphBytes = 0, p.morphFile = 0, p.flags |= kMorphWide; });
    bad("attributes", [](PageRecord& p) { p.flags = kPageNormals; });
    bad("impossible", [](PageRecord& p) { p.flags = 64; });
    bad("impossible", [](PageRecord& p) { p.reserved = 1; });
    bad("impossible", [](PageRecord& p) { p.vertexCount = 70000; });
    bad("impossible", [](PageRecord& p) { p.indexCount = 0xfffffffd; });
    bad("impossible", [](PageRecord& p) { p.rangeCount = 0x80000000; });
}

// Whatever records say, under right checksums: refused, or good enough to be walked.
TEST_F(HierarchyTest, NoRecordsCanDoHarm) {
    std::mt19937 random(1);
    const auto change = [&](auto& records) {
        const auto bytes = std::as_writable_bytes(std::span(records));
        std::byte& byte = bytes[random() % bytes.size()];
        constexpr std::array<unsigned, 6> kValues{0, 1, 2, 0x7f, 0x80, 0xff};
        byte = static_cast<std::byte>(kValues[random() % kValues.size()]);
    };
    for (int i = 0; i < 1000; ++i) {
        Hierarchy hierarchy = makeHierarchy();
        for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
            const unsigned kind = static_cast<unsigned>(random() % 3);
            if (kind == 0) change(hierarchy.nodes);
            if (kind == 1) change(hierarchy.entries);
            if (kind == 2) change(hierarchy.pages);
        }
        if (!checkHierarchy("hierarchy", hierarchy, makeManifest()).ok()) continue;
        for (unsigned level = 0; level < 4; ++level) {
            for (const NodeRecord& node : hierarchy.nodes) hierarchy.drawnAt(node, level);
        }
        EXPECT_EQ(cellsOfNodes(hierarchy).size(), 4u);
        EXPECT_EQ(summariseLevels(hierarchy, -20).full, makeManifest().full);
    }
}

TEST_F(HierarchyTest, TotalsMustBeTheManifests) {
    const auto loads = [&](const std::function<void(Manifest&)>& change) {
        Manifest manifest = makeManifest();
        change(manifest);
        return loadHierarchy(directory_.path(""), manifest).ok();
    };
    EXPECT_TRUE(loads([](Manifest&) {}));
    EXPECT_FALSE(loads([](Manifest& m) { m.triangles = 18; }));
    EXPECT_FALSE(loads([](Manifest& m) { m.vertices = 54; }));
    EXPECT_FALSE(loads([](Manifest& m) { m.leaves = 2; }));
    EXPECT_FALSE(loads([](Manifest& m) { m.levels[1].triangles = 12; }));
    EXPECT_FALSE(loads([](Manifest& m) { m.levels[1].bytes = 12; }));
    EXPECT_FALSE(loads([](Manifest& m) { m.levels[2].error *= 2; }));
    EXPECT_FALSE(loads([](Manifest& m) { m.levels.pop_back(); }));
    EXPECT_FALSE(loads([](Manifest& m) { m.full.bytes = 12; }));
}

}  // namespace
}  // namespace iwalk
