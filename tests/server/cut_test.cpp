#include "server/adapt/cut.hpp"

#include <gtest/gtest.h>

#include "tests/common/dataset_fixture.hpp"

namespace iwalk {
namespace {

using Entries = std::vector<std::uint32_t>;
constexpr std::uint32_t kNone = Cut::kNothing;

TEST(CutTest, DrawsTheWholeModelAtALevel) {
    const Hierarchy hierarchy = makeHierarchy();
    EXPECT_EQ(cutAtLevel(hierarchy, 0).entry, (Entries{0, kNone, kNone, kNone}));
    EXPECT_EQ(cutAtLevel(hierarchy, 1).entry, (Entries{1, 3, 5, 6}));
    EXPECT_EQ(cutAtLevel(hierarchy, 2).entry, (Entries{2, 4, 5, 7}));
    EXPECT_EQ(cutAtLevel(hierarchy, kFullLevel).entry, (Entries{2, 4, 5, 8}));
}

TEST(CutTest, LevelsFinerThanAllAreFull) {
    const Hierarchy hierarchy = makeHierarchy();
    for (const unsigned level : {3u, 77u, 254u}) {
        EXPECT_EQ(cutAtLevel(hierarchy, level).entry, cutAtLevel(hierarchy, kFullLevel).entry) << level;
    }
}

TEST(CutTest, WithoutLevelsEverythingIsFull) {
    Hierarchy hierarchy = makeHierarchy();
    std::vector<LevelRecord> full;
    for (const NodeRecord& node : hierarchy.nodes) full.push_back(*hierarchy.fullEntryOf(node));
    hierarchy.entries = full;
    for (std::uint32_t n = 0; n < 4; ++n)
        hierarchy.nodes[n].firstEntry = n, hierarchy.nodes[n].entryCount = 1;
    const Entries wanted{0, 1, 2, 3};
    EXPECT_EQ(cutAtLevel(hierarchy, 0).entry, wanted);
    EXPECT_EQ(cutAtLevel(hierarchy, kFullLevel).entry, wanted);
}

}  // namespace
}  // namespace iwalk
