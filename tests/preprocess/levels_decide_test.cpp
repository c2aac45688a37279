// What one cell decides, where more triangles reach into it than it can do anything about.
#include <gtest/gtest.h>

#include <set>

#include "common/dataset/hierarchy.hpp"
#include "preprocess/levels/decide.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/gateway/allocation.hpp"
#include "tests/preprocess/levels_models.hpp"

namespace iwalk {
namespace {

constexpr unsigned kAround = 100'000;  // triangles around the hub

// A crowd of long triangles around one vertex, the hub, which is also in the middle of a small flat grid.
FakeInput makeHub() {
    constexpr int kHalf = 20;
    FakeInput input = fan(kAround);
    const auto at = [](int column, int row) { return glm::dvec3(0.001 * column, 0.001 * row, 0); };
    for (int row = -kHalf; row < kHalf; ++row) {
        for (int column = -kHalf; column < kHalf; ++column) {
            const glm::dvec3 a = at(column, row), c = at(column + 1, row + 1);
            input.triangles.push_back(makeTriangle(a, at(column + 1, row), c));
            input.triangles.push_back(makeTriangle(a, c, at(column, row + 1)));
        }
    }
    return input;
}

class DecideTest : public ::testing::Test {
  protected:
    void SetUp() override {
        manifest_ = buildFrom(makeHub(), directory_.path("d"), {}).value();
        hierarchy_ = loadHierarchy(directory_.path("d"), manifest_).value();
        lattice_ = {manifest_.stepExponent, hierarchy_.rootCell, hierarchy_.rootCellLog2};
        const std::vector<std::string> paths{directory_.path("d/" + manifest_.pageFiles.at(0).name)};
        store_ = PageStore::open(paths, lattice_, std::size_t{1} << 30).value();
        errors_ = VertexErrors::create(directory_.path("")).value();
        stage_.limits = limitsAt(lattice_.rootCellLog2, 5);
        stage_.errors = &errors_;
        addPages();
    }

    // All of full resolution, which the store then has in memory.
    void addPages() {
        std::set<std::uint32_t> numbers;
        for (const LevelRecord& entry : hierarchy_.entries) {
            for (std::uint32_t i = 0; entry.level == kFullLevel && i < entry.pageCount; ++i)
                numbers.insert(entry.firstPage + i);
        }
        for (const std::uint32_t number : numbers) {
            StagePage page;
            page.number = number;
            page.record = hierarchy_.pages[number];
            page.fresh = true;
            touching_.push_back(static_cast<std::uint32_t>(stage_.pages.size()));
            stage_.pages.push_back(page);
            pages_.push_back(store_->get(number, page.record).value());
        }
    }

    TempDirectory directory_;
    Manifest manifest_;
    Hierarchy hierarchy_;
    Lattice lattice_;
    VertexErrors errors_;
    std::unique_ptr<PageStore> store_;
    Stage stage_;
    std::vector<std::uint32_t> touching_;
    std::vector<std::shared_ptr<const SourcePage>> pages_;
};

TEST_F(DecideTest, AHubStaysAndItsCrowdTakesNoMemory) {
    const CellPoint hub(-lattice_.rootCell);
    const std::uint64_t reach = std::uint64_t{1}
                                << (lattice_.rootCellLog2 - 6);  // the grid, and no rib's end
    const SpaceCell cell{hub - reach, hub + reach};
    std::size_t atHub = 0;  // vertices of pages
    for (const auto& page : pages_) atHub += std::ranges::count(page->positions, hub);
    ASSERT_GE(atHub, 2u);

    testing::resetLargestAllocation();
    const auto decision = decideCell(cell, stage_, touching_, *store_, 131'072);
    const std::size_t largest = testing::largestAllocation();
    ASSERT_TRUE(decision.ok()) << decision.error().message;
    // All of the crowd's points and triangles would take more than 2 MiB each.
    EXPECT_LT(largest, std::size_t{512} << 10);
    EXPECT_GT(decision->targets.size(), 1000u);  // the grid's vertices
    for (const VertexTarget& target : decision->targets) {
        const CellPoint& from = pages_[target.stagePage]->positions[target.vertex];
        EXPECT_TRUE(cell.contains(from) && cell.contains(target.position));
        if (from == hub) {
            EXPECT_EQ(target.position, hub);
        }
    }
}

}  // namespace
}  // namespace iwalk
