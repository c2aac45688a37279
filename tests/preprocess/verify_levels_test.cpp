// Levels that do not follow from one another, in datasets that are good otherwise.
#include <cmath>
#include <map>
#include <tuple>

#include "tests/preprocess/verify_fixture.hpp"

namespace iwalk {
namespace {

// A wavy sheet of 28,800 triangles: its pages meet along borders.
FakeInput makeSheet() {
    constexpr int kSide = 120;
    const auto at = [](int x, int y) { return glm::dvec3(x, y, 3 * std::sin(0.1 * x) * std::cos(0.13 * y)); };
    FakeInput sheet;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            sheet.triangles.push_back(makeTriangle(at(x, y), at(x + 1, y), at(x, y + 1)));
            sheet.triangles.push_back(makeTriangle(at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)));
        }
    }
    return sheet;
}

class VerifyLevelsTest : public VerifyFixture {
  protected:
    VerifyLevelsTest() : VerifyFixture(makeSheet()) {
        for (const LevelRecord& entry : hierarchy_.entries) {
            for (std::uint32_t i = 0; i < entry.pageCount; ++i) levels_[entry.firstPage + i] = entry.level;
        }
        for (std::size_t p = 0; p < open_.size(); ++p) {
            if (levels_[p] != kFullLevel) continue;
            for (const LatticePoint& at : open_[p].positions()) ++pagesAt_[key(at)];
        }
    }

    static std::tuple<std::int64_t, std::int64_t, std::int64_t> key(const LatticePoint& p) {
        return {p.x, p.y, p.z};
    }
    // Of input vertices, with a page of full that has them.
    bool isShared(const OpenPage& page, std::size_t v) const {
        return pagesAt_.at(key(page.position(v))) > 1;
    }
    static bool moves(const OpenPage& page, std::size_t v) { return page.targets[v] != page.position(v); }

    std::map<std::size_t, unsigned> levels_;  // by page
    std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t>, int> pagesAt_;
};

TEST_F(VerifyLevelsTest, GoodLevelsAreGood) {
    ASSERT_TRUE(hierarchy_.hasLevels());
    EXPECT_GT(manifest_.levels.size(), 2u);
    EXPECT_GT(open_.size(), 10u);
    EXPECT_EQ(withMistake([](std::vector<OpenPage>&, Hierarchy&) {}), "");
}

TEST_F(VerifyLevelsTest, PagesMustAgreeOnTargets) {
    const std::string problem = withMistake([&](std::vector<OpenPage>& pages, Hierarchy&) {
        for (std::size_t p = 0; p < pages.size(); ++p) {
            if (levels_[p] != kFullLevel || pages[p].targets.empty()) continue;
            for (std::size_t v = 0; v < pages[p].targets.size(); ++v) {
                if (!isShared(pages[p], v) || !moves(pages[p], v)) continue;
                pages[p].targets[v] = pages[p].position(v);
                return;
            }
        }
        ADD_FAILURE() << "no page shares a vertex that moves";
    });
    EXPECT_NE(problem.find("goes elsewhere than in another page"), std::string::npos) << problem;
}

// The corner of a triangle that stays a triangle goes where a vertex is that goes away.
TEST_F(VerifyLevelsTest, TargetsMustBeThere) {
    const std::string problem = withMistake([&](std::vector<OpenPage>& pages, Hierarchy&) {
        OpenPage& page = pages[0];
        const std::vector<LatticePoint> targets = page.targets;
        std::size_t gone = 0;
        while (!moves(page, gone) || isShared(page, gone)) ++gone;
        for (std::size_t i = 0; i < page.geometry.indices.size(); i += 3) {
            const std::uint16_t* corner = &page.geometry.indices[i];
            const LatticePoint &a = targets[corner[0]], &b = targets[corner[1]], &c = targets[corner[2]];
            if (a == b || b == c || c == a || isShared(page, corner[0])) continue;
            page.targets[corner[0]] = page.position(gone);
            return;
        }
        ADD_FAILURE() << "no triangle stays one";
    });
    EXPECT_NE(problem.find("goes where the coarser level has none"), std::string::npos) << problem;
}

TEST_F(VerifyLevelsTest, BoxesMustContainThoseOfFinerLevels) {
    const std::string problem = withMistake([](std::vector<OpenPage>& pages, Hierarchy& hierarchy) {
        constexpr int kMore = 1 << 18;
        for (Range& range : pages[0].geometry.ranges) range.boxMax[0] += kMore;
        for (NodeRecord& node : hierarchy.nodes) {
            node.boxMax[0] += kMore;
            if (!Hierarchy::ownBox(node).empty()) node.ownMax[0] += kMore;
        }
    });
    EXPECT_NE(problem.find("box reaches out of that of its range in the coarser level"), std::string::npos)
        << problem;
    EXPECT_NE(problem.find("page 0 at byte"), std::string::npos) << problem;
}

// A range of a coarser level says that it is a part of its cell only.
TEST_F(VerifyLevelsTest, RangesMustBeOfTheCellsOfFinerOnes) {
    const std::string problem = withMistake([&](std::vector<OpenPage>& pages, Hierarchy&) {
        ASSERT_EQ(levels_[pages.size() - 1], 0u);
        pages.back().geometry.ranges.back().path <<= 3 * (kMaxPathLevels - 4);
    });
    EXPECT_NE(problem.find("lies in no range of the coarser level"), std::string::npos) << problem;
}

// Ranges of an entry of everything below a node may be parts of the one before, but not the other way round.
TEST_F(VerifyLevelsTest, RangesOfWholeEntriesMustBeInOrder) {
    const auto withPaths = [&](std::uint32_t first, std::uint32_t second) {
        return withMistake([&](std::vector<OpenPage>& pages, Hierarchy& hierarchy) {
            ASSERT_EQ(hierarchy.entries[0].firstPage + 1, pages.size());
            ASSERT_EQ(hierarchy.entries[0].rangeCount, 1);
            hierarchy.entries[0].rangeCount = 2;
            std::vector<Range>& ranges = pages.back().geometry.ranges;
            ranges.push_back(ranges[0]);
            ranges[0].path = first, ranges[1].path = second;
            ranges[0].indexCount = ranges[1].firstIndex = 3;
            ranges[1].indexCount -= 3;
        });
    };
    const std::string refused = withPaths(0b1'000, 0b1);
    EXPECT_NE(refused.find("range 1: path 0x1 does not follow 0x8"), std::string::npos) << refused;
    EXPECT_EQ(withPaths(0b1, 0b1'000), "");
    EXPECT_EQ(withPaths(0b1, 0b1), "");
}

}  // namespace
}  // namespace iwalk
