#include "common/dataset/manifest.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/file.hpp"
#include "tests/common/dataset_fixture.hpp"

namespace iwalk {
namespace {

class ManifestTest : public DatasetTest {
  protected:
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
};

TEST_F(ManifestTest, RoundTrips) {
    const auto loaded = loadManifest(directory_.path(""));
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    const Manifest wanted = makeManifest();
    EXPECT_EQ(loaded->generation, wanted.generation);
    EXPECT_EQ(loaded->bounds, wanted.bounds);
    EXPECT_EQ(loaded->stepExponent, wanted.stepExponent);
    EXPECT_EQ(loaded->triangles, wanted.triangles);
    EXPECT_EQ(loaded->vertices, wanted.vertices);
    EXPECT_EQ(loaded->leaves, wanted.leaves);
    EXPECT_EQ(loaded->leafTriangles, wanted.leafTriangles);
    EXPECT_EQ(loaded->levels, wanted.levels);
    EXPECT_EQ(loaded->full, wanted.full);
    EXPECT_TRUE(loaded->colors);
    EXPECT_FALSE(loaded->normals);
    EXPECT_EQ(loaded->hierarchy.name, wanted.hierarchy.name);
    EXPECT_EQ(loaded->pageFiles.at(0).bytes, 2400u);
    EXPECT_EQ(loaded->provenance.at(0).input, "rack \"1\".ply");
    EXPECT_EQ(loaded->provenance.at(0).droppedDegenerate, 2u);
}

TEST_F(ManifestTest, ErrorsNameTheKey) {
    EXPECT_NE(manifestWith("/version", 7).find("dataset version 7, but this program reads version 1"),
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
    EXPECT_NE(manifestWith("/leaf_triangles", -1).find("\"leaf_triangles\""), std::string::npos);
    EXPECT_NE(manifestWith("/levels", 3).find("\"levels\" must be a list"), std::string::npos);
    EXPECT_NE(manifestWith("/levels/1", 3).find("\"levels\" must be made of objects"), std::string::npos);
    for (const nlohmann::json& bad : {nlohmann::json(-0.5), nlohmann::json("1"), nlohmann::json(nullptr)}) {
        EXPECT_NE(manifestWith("/levels/2/error", bad).find("\"error\" must be a finite"), std::string::npos);
    }
    EXPECT_NE(manifestWith("/full/triangles", 0.5).find("\"triangles\""), std::string::npos);
    EXPECT_NE(manifestWith("/page_files", 3).find("\"page_files\" must be a list"), std::string::npos);
}

TEST_F(ManifestTest, NamesOnlyFilesOfItsDirectory) {
    for (const char* name : {"../pages-3.bin", "/etc/passwd", "", ".", "a/b"}) {
        EXPECT_NE(manifestWith("/hierarchy/name", name).find("plain file name"), std::string::npos) << name;
    }
    EXPECT_NE(manifestWith("/page_files/0/name", "pages-4.bin").find("pages-4.bin: missing"),
              std::string::npos);
    EXPECT_NE(manifestWith("/page_files/0/bytes", 999).find("2400 bytes where dataset.json says 999"),
              std::string::npos);
}

TEST_F(ManifestTest, TruncatedAnywhereIsRefused) {
    const std::string text = readWholeFile(directory_.path(kManifestName), 99999).value();
    for (std::size_t length = 0; length + 2 < text.size(); ++length) {
        directory_.write(kManifestName, text.substr(0, length));
        EXPECT_FALSE(loadManifest(directory_.path("")).ok()) << length;
    }
    EXPECT_NE(loadManifest("/nowhere").error().message.find("/nowhere/dataset.json"), std::string::npos);
}

}  // namespace
}  // namespace iwalk
