#include "preprocess/build/verify.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "common/dataset/hierarchy.hpp"
#include "common/file.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/soup.hpp"

namespace iwalk {
namespace {

class VerifyTest : public testing::Test {
  protected:
    VerifyTest() {
        const auto built = buildFrom(makeSoup(3000, 0.01, 0.5, 1, true), dataset(), {.leafTriangles = 300});
        EXPECT_TRUE(built.ok());
        manifest_ = *built;
        hierarchy_ = loadHierarchy(dataset(), manifest_).value();
        pages_ = readWholeFile(dataset() + "/pages-1.bin", 1u << 30).value();
    }
    std::string dataset() const { return directory_.path("d"); }

    Result<Verification> verify() const {
        NoProgress progress;
        return verifyDataset(dataset(), progress);
    }

    PageGeometry decode(const PageRecord& record) const {
        const auto bytes = std::as_bytes(std::span(pages_)).subspan(record.offset, record.bytes);
        const PageLayout layout = pageLayout(record);
        std::vector<std::byte> decoded(layout.bytes);
        const PageTable table = decodePage(bytes, record, decoded).value();
        PageGeometry page;
        page.origin = table.origin;
        page.ranges = table.ranges;
        page.attributes = record.flags & ~kPageWide;
        for (std::uint32_t v = 0; v < record.vertexCount; ++v) {
            const glm::u32vec3 offset = pageOffset(decoded, record, v);
            page.vertices.push_back({{offset.x, offset.y, offset.z}, 0, 0});
        }
        page.indices.resize(record.indexCount);
        std::memcpy(page.indices.data(), decoded.data() + layout.indices, 2 * record.indexCount);
        return page;
    }

    // What verify says when page 1 was written with a mistake, but with right checksums.
    std::string withMistake(const std::function<void(PageGeometry&, Hierarchy&)>& mistake) {
        Hierarchy hierarchy = hierarchy_;
        std::string all;
        for (std::size_t p = 0; p < hierarchy.pages.size(); ++p) {
            PageGeometry page = decode(hierarchy_.pages[p]);
            if (p == 1) mistake(page, hierarchy);
            hierarchy.pages[p].offset = all.size();
            const std::vector<std::byte> bytes = encodePage(page, hierarchy.pages[p]);
            all.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        }
        Manifest manifest = manifest_;
        manifest.pageFiles[0].bytes = all.size();
        directory_.write("d/pages-1.bin", all);
        EXPECT_TRUE(saveHierarchy(dataset() + "/hierarchy-1.bin", hierarchy).ok());
        EXPECT_TRUE(saveManifest(dataset(), manifest).ok());
        const auto result = verify();
        if (!result) return result.error().message;
        return result->problems.empty() ? "" : result->problems[0];
    }

    TempDirectory directory_;
    Manifest manifest_;
    Hierarchy hierarchy_;
    std::string pages_;
};

TEST_F(VerifyTest, GoodDatasetsAreGood) {
    const auto result = verify();
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_EQ(result->problems, std::vector<std::string>{});
    EXPECT_EQ(result->triangles, manifest_.triangles);
    EXPECT_EQ(result->pages, manifest_.pages);
    EXPECT_EQ(result->bytes, manifest_.pageFiles[0].bytes);
    EXPECT_GT(result->pages, 3u);
    EXPECT_EQ(withMistake([](PageGeometry&, Hierarchy&) {}), "");
}

// A byte in the header, in each stream and at the end of each page.
TEST_F(VerifyTest, FlippedBytesAreNamedByPageAndOffset) {
    for (std::size_t p = 0; p < hierarchy_.pages.size(); ++p) {
        const PageRecord& record = hierarchy_.pages[p];
        std::vector<std::uint64_t> places{0, 4, 24, 60, kPageHeaderBytes - 1, record.bytes - 1};
        for (std::size_t stream = 0; stream < 5; ++stream) {
            std::uint32_t offset = 0;
            std::memcpy(&offset, pages_.data() + record.offset + 48 + 16 * stream, 4);
            places.push_back(offset + 1);
        }
        for (const std::uint64_t place : places) {
            std::string bad = pages_;
            bad[record.offset + place] = static_cast<char>(bad[record.offset + place] ^ 0x20);
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

TEST_F(VerifyTest, BoxesMustBeExact) {
    const auto named = [](const std::string& problem, const char* what) {
        EXPECT_NE(problem.find(what), std::string::npos) << problem;
        EXPECT_NE(problem.find("page 1 at byte"), std::string::npos) << problem;
    };
    named(withMistake([](PageGeometry& page, Hierarchy&) { ++page.ranges[0].boxMax[1]; }), "box is not that");
    named(withMistake([](PageGeometry& page, Hierarchy&) {
              page.vertices[page.indices[0]].offset[2] = page.ranges[0].boxMax[2] + 1;
          }),
          "");
}

TEST_F(VerifyTest, TrianglesMustBeWhereTheyBelong) {
    const std::string problem = withMistake([](PageGeometry& page, Hierarchy&) { page.origin.x += 1 << 24; });
    EXPECT_NE(problem.find("does not belong into node"), std::string::npos) << problem;
}

TEST_F(VerifyTest, NodesBoxesMustBeExact) {
    const std::string problem = withMistake([](PageGeometry&, Hierarchy& hierarchy) {
        // Every box on the way up grows, so that the hierarchy by itself is consistent.
        for (NodeRecord& node : hierarchy.nodes) {
            node.boxMax[0] += 5;
            if (node.triangles > 0) node.ownMax[0] += 5;
        }
    });
    EXPECT_NE(problem.find("own box is not that of its triangles"), std::string::npos) << problem;
}

}  // namespace
}  // namespace iwalk
