#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "common/dataset/level_summary.hpp"
#include "common/dataset/morph.hpp"
#include "common/file.hpp"
#include "preprocess/build/verify.hpp"
#include "tests/common/temp_directory.hpp"
#include "tests/preprocess/soup.hpp"

namespace iwalk {

// A page that can be changed and written again; colours and normals are lost.
struct OpenPage {
    PageGeometry geometry;
    std::vector<LatticePoint> targets;  // empty: no morph block

    LatticePoint position(std::size_t v) const {
        const std::uint32_t(&offset)[3] = geometry.vertices[v].offset;
        return geometry.origin + LatticePoint(offset[0], offset[1], offset[2]);
    }
    std::vector<LatticePoint> positions() const {
        std::vector<LatticePoint> all;
        for (std::size_t v = 0; v < geometry.vertices.size(); ++v) all.push_back(position(v));
        return all;
    }
};

// A dataset that mistakes can be made in.
class VerifyFixture : public testing::Test {
  protected:
    explicit VerifyFixture(const FakeInput& input) {
        const auto built = buildFrom(input, dataset(), {.leafTriangles = 1500});
        EXPECT_TRUE(built.ok());
        manifest_ = *built;
        hierarchy_ = loadHierarchy(dataset(), manifest_).value();
        pages_ = readWholeFile(dataset() + "/pages-1.bin", 1u << 30).value();
        for (const PageRecord& record : hierarchy_.pages) open_.push_back(open(record));
    }
    std::string dataset() const { return directory_.path("d"); }

    Result<Verification> verify() const {
        NoProgress progress;
        return verifyDataset(dataset(), progress);
    }

    // What verify says first when the dataset was written with a mistake, but with right checksums.
    std::string withMistake(const std::function<void(std::vector<OpenPage>&, Hierarchy&)>& mistake) {
        Hierarchy hierarchy = hierarchy_;
        std::vector<OpenPage> pages = open_;
        mistake(pages, hierarchy);
        std::string all;
        for (std::size_t p = 0; p < pages.size(); ++p) write(pages[p], hierarchy.pages[p], all);
        Manifest manifest = manifest_;
        const LevelSummaries summaries = summariseLevels(hierarchy, manifest.stepExponent);
        manifest.levels = summaries.levels;
        manifest.full = summaries.full;
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
    std::vector<OpenPage> open_;

  private:
    OpenPage open(const PageRecord& record) const {
        const auto file = std::as_bytes(std::span(pages_));
        const PageLayout layout = pageLayout(record);
        std::vector<std::byte> decoded(layout.bytes);
        const PageTable table =
            decodePage(file.subspan(record.offset, record.bytes), record, decoded).value();
        OpenPage page;
        page.geometry.origin = table.origin;
        page.geometry.ranges = table.ranges;
        page.geometry.attributes = record.flags & (kPageColors | kPageNormals);
        for (std::uint32_t v = 0; v < record.vertexCount; ++v) {
            const glm::u32vec3 offset = pageOffset(decoded, record, v);
            page.geometry.vertices.push_back({{offset.x, offset.y, offset.z}, 0, 0});
        }
        page.geometry.indices.resize(record.indexCount);
        std::memcpy(page.geometry.indices.data(), decoded.data() + layout.indices, 2 * record.indexCount);
        if (record.morphBytes == 0) return page;
        const auto block = file.subspan(record.morphOffset, record.morphBytes);
        page.targets = targetsOf(decodeMorph(block, record, table).value(), page.positions());
        return page;
    }

    static void write(const OpenPage& page, PageRecord& record, std::string& all) {
        const PageGeometry& geometry = page.geometry;
        const auto append = [&](std::uint64_t& offset, const std::vector<std::byte>& bytes) {
            offset = all.size();
            all.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        };
        append(record.offset, encodePage(geometry, record));
        if (page.targets.empty()) return;
        const std::vector<LatticePoint> positions = page.positions();
        append(record.morphOffset,
               encodeMorph({geometry.origin, positions, page.targets, geometry.ranges, geometry.indices},
                           record));
    }
};

}  // namespace iwalk
