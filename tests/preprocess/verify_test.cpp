#include "tests/preprocess/verify_fixture.hpp"

namespace iwalk {
namespace {

class VerifyTest : public VerifyFixture {
  protected:
    VerifyTest() : VerifyFixture(makeSoup(9000, 0.01, 0.5, 1, true)) {}

    // In page 1, which has triangles of the input.
    std::string inPage1(const std::function<void(PageGeometry&, Hierarchy&)>& mistake) {
        return withMistake([&](std::vector<OpenPage>& pages, Hierarchy& hierarchy) {
            mistake(pages[1].geometry, hierarchy);
        });
    }
};

TEST_F(VerifyTest, GoodDatasetsAreGood) {
    const auto result = verify();
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_EQ(result->problems, std::vector<std::string>{});
    EXPECT_GT(result->triangles, manifest_.triangles);
    EXPECT_EQ(result->pages, manifest_.pages);
    EXPECT_EQ(result->bytes, manifest_.pageFiles[0].bytes);
    EXPECT_GT(result->pages, 3u);
    EXPECT_EQ(withMistake([](std::vector<OpenPage>&, Hierarchy&) {}), "");
}

// A byte in the header, in each stream and at the end of every third page and its morph block.
TEST_F(VerifyTest, FlippedBytesAreNamedByPageAndOffset) {
    for (std::size_t p = 0; p < hierarchy_.pages.size(); p += 3) {
        const PageRecord& record = hierarchy_.pages[p];
        std::vector<std::uint64_t> places{0, 4, 24, 60, kPageHeaderBytes - 1, record.bytes - 1};
        for (std::size_t stream = 0; stream < 5; ++stream) {
            std::uint32_t offset = 0;
            std::memcpy(&offset, pages_.data() + record.offset + 48 + 16 * stream, 4);
            places.push_back(offset + 1);
        }
        for (std::uint64_t& place : places) place += record.offset;
        for (const std::uint32_t place : {0u, 20u, 50u, kMorphHeaderBytes + 3, record.morphBytes - 1}) {
            if (record.morphBytes > 0) places.push_back(record.morphOffset + place);
        }
        for (const std::uint64_t place : places) {
            std::string bad = pages_;
            bad[place] = static_cast<char>(bad[place] ^ 0x20);
            directory_.write("d/pages-1.bin", bad);
            const auto result = verify();
            ASSERT_TRUE(result.ok());
            ASSERT_EQ(result->problems.size(), 1u) << "page " << p << " byte " << place;
            const std::string wanted =
                fmt::format("{}/pages-1.bin: page {} at byte {}: ", dataset(), p, record.offset);
            EXPECT_EQ(result->problems[0].substr(0, wanted.size()), wanted);
        }
    }
}

TEST_F(VerifyTest, FlippedBytesInTheHierarchyAreFound) {
    const std::string good = readWholeFile(dataset() + "/hierarchy-1.bin", 1u << 30).value();
    for (std::size_t at = 0; at < good.size(); at += 37) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ 1);
        directory_.write("d/hierarchy-1.bin", bad);
        const auto result = verify();
        ASSERT_FALSE(result.ok()) << at;
        EXPECT_NE(result.error().message.find("hierarchy-1.bin"), std::string::npos);
    }
}

TEST_F(VerifyTest, MissingAndShortFilesAreFound) {
    directory_.write("d/pages-1.bin", pages_.substr(0, pages_.size() - 1));
    EXPECT_NE(verify().error().message.find("pages-1.bin"), std::string::npos);
    std::filesystem::remove(dataset() + "/hierarchy-1.bin");
    EXPECT_NE(verify().error().message.find("hierarchy-1.bin: missing"), std::string::npos);
    NoProgress progress;
    EXPECT_FALSE(verifyDataset("/nowhere", progress).ok());
}

// Right as pages go, and yet not what their nodes say.
TEST_F(VerifyTest, RangesMustFitTheirNodes) {
    const auto named = [](const std::string& problem, const char* what) {
        EXPECT_NE(problem.find(what), std::string::npos) << problem;
        EXPECT_NE(problem.find("page 1 at byte"), std::string::npos) << problem;
    };
    named(inPage1([](PageGeometry& page, Hierarchy&) { page.ranges[0].boxMax[1] += 1 << 24; }),
          "range 0: box reaches out of that of node");
    named(inPage1([](PageGeometry& page, Hierarchy&) { page.ranges[0].path <<= 3; }),
          "does not belong into node");
    named(inPage1([](PageGeometry& page, Hierarchy&) {
              for (Range& range : page.ranges) range.path = kRootPath;
          }),
          "range 1: path 0x1 does not follow 0x1");
}

TEST_F(VerifyTest, TrianglesMustBeWhereTheyBelong) {
    const std::string problem = inPage1([](PageGeometry& page, Hierarchy& hierarchy) {
        page.origin.x += 1 << 24;
        for (NodeRecord& node : hierarchy.nodes) {  // large enough for that, and consistent
            node.boxMax[0] += 1 << 24;
            if (!Hierarchy::ownBox(node).empty()) node.ownMax[0] += 1 << 24;
        }
    });
    EXPECT_NE(problem.find("does not belong into node"), std::string::npos) << problem;
}

TEST_F(VerifyTest, NodesBoxesMustContainTheirRanges) {
    const std::string problem = inPage1([](PageGeometry&, Hierarchy& hierarchy) {
        for (NodeRecord& node : hierarchy.nodes) {
            if (!Hierarchy::ownBox(node).empty()) node.ownMax[0] -= 5;
        }
    });
    EXPECT_NE(problem.find("box reaches out of that of node"), std::string::npos) << problem;
}

}  // namespace
}  // namespace iwalk
