#include "tests/preprocess/soup.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <random>
#include <set>

#include "common/dataset/hierarchy.hpp"
#include "common/dataset/manifest.hpp"
#include "common/dataset/page_files.hpp"

namespace iwalk {
namespace {

class FakeImporter : public Importer {
  public:
    explicit FakeImporter(FakeInput input) : input_(std::move(input)) {}

    Result<ImportSummary> scan(const VertexSink& vertices, const ProgressSink& progress) override {
        ImportSummary summary;
        for (const Triangle& triangle : input_.triangles) {
            std::array<glm::dvec3, 3> positions;
            for (std::size_t c = 0; c < 3; ++c) summary.bounds.add(positions[c] = triangle[c].position);
            vertices(positions);
        }
        summary.vertices = 3 * input_.triangles.size();
        summary.triangleBound = input_.triangles.size();
        summary.precision = input_.precision;
        summary.colors = input_.colors;
        summary.normals = input_.normals;
        progress(1);
        return summary;
    }

    Result<ImportCounts> triangles(const TriangleSink& sink, const ProgressSink& progress) override {
        constexpr std::size_t kBatch = 1000;
        const std::span<const Triangle> all(input_.triangles);
        for (std::size_t i = 0; i < all.size(); i += kBatch) {
            if (i >= input_.failAfter) return fail("fake.ply: byte 7: broken");
            const auto some = all.subspan(i, std::min(kBatch, all.size() - i));
            std::vector<Triangle> batch(some.begin(), some.end());
            RETURN_IF_ERROR(sink(batch));
            progress(static_cast<double>(i) / static_cast<double>(all.size()));
        }
        return ImportCounts{all.size(), 0};
    }

  private:
    FakeInput input_;
};

// Starts the corners at the least one.
StoredTriangle canonical(const std::array<std::array<std::int64_t, 5>, 3>& corners) {
    const std::size_t first = static_cast<std::size_t>(std::ranges::min_element(corners) - corners.begin());
    StoredTriangle stored{};
    for (std::size_t i = 0; i < 15; ++i) stored[i] = corners[(first + i / 5) % 3][i % 5];
    return stored;
}

void appendPage(const RandomAccessFile& file, const PageRecord& record,
                std::vector<StoredTriangle>& triangles) {
    std::vector<std::byte> bytes(record.bytes);
    ASSERT_TRUE(file.readAt(record.offset, bytes).ok());
    const PageLayout layout = pageLayout(record);
    std::vector<std::byte> decoded(layout.bytes);
    const auto table = decodePage(bytes, record, decoded);
    ASSERT_TRUE(table.ok()) << table.error().message;
    for (std::uint32_t i = 0; i < record.indexCount; i += 3) {
        std::array<std::array<std::int64_t, 5>, 3> corners{};
        for (std::uint32_t c = 0; c < 3; ++c) {
            std::uint16_t index = 0;
            std::memcpy(&index, decoded.data() + layout.indices + 2 * (i + c), 2);
            const LatticePoint p = table->origin + LatticePoint(pageOffset(decoded, record, index));
            std::uint32_t color = 0, normal = 0;
            if ((record.flags & kPageColors) != 0)
                std::memcpy(&color, decoded.data() + layout.colors + 4 * index, 4);
            if ((record.flags & kPageNormals) != 0)
                std::memcpy(&normal, decoded.data() + layout.normals + 4 * index, 4);
            corners[c] = {p.x, p.y, p.z, color, normal};
        }
        triangles.push_back(canonical(corners));
    }
}

}  // namespace

ImporterFactory fakeImporters(std::vector<std::pair<std::string, FakeInput>> inputs) {
    return [inputs = std::move(inputs)](const std::string& path,
                                        const ImportLimits&) -> Result<std::unique_ptr<Importer>> {
        for (const auto& [name, input] : inputs) {
            if (name == path) return std::unique_ptr<Importer>(std::make_unique<FakeImporter>(input));
        }
        return fail("{}: no such fake", path);
    };
}

Triangle makeTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    Triangle triangle;
    triangle[0].position = a, triangle[1].position = b, triangle[2].position = c;
    return triangle;
}

FakeInput makeSoup(std::size_t triangles, double smallest, double largest, unsigned seed, bool attributes) {
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss;
    std::uniform_real_distribution<double> uniform(-1, 1);
    FakeInput input;
    input.colors = input.normals = attributes;
    for (std::size_t i = 0; i < triangles; ++i) {
        const glm::dvec3 center(gauss(random), gauss(random), gauss(random));
        const double size = smallest * std::pow(largest / smallest, (uniform(random) + 1) / 2);
        Triangle& triangle = input.triangles.emplace_back();
        for (Corner& corner : triangle) {
            for (std::size_t a = 0; a < 3; ++a) {
                corner.position[a] = static_cast<float>(center[a] + size * uniform(random));
            }
            if (!attributes) continue;
            corner.color = static_cast<std::uint32_t>(random()) | 0xff000000u;
            corner.normal = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
        }
    }
    return input;
}

void writePly(const std::string& path, const std::vector<Triangle>& triangles) {
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << 3 * triangles.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << triangles.size()
         << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Triangle& triangle : triangles) {
        for (const Corner& corner : triangle) {
            const glm::vec3 p(corner.position);
            file.write(reinterpret_cast<const char*>(&p), sizeof(p));
        }
    }
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(3 * triangles.size()); i += 3) {
        const std::array<std::int32_t, 3> indices{i, i + 1, i + 2};
        file.put(3).write(reinterpret_cast<const char*>(indices.data()), sizeof(indices));
    }
}

std::vector<StoredTriangle> readTriangles(const std::string& dataset) {
    std::vector<StoredTriangle> triangles;
    const auto manifest = loadManifest(dataset);
    EXPECT_TRUE(manifest.ok()) << manifest.error().message;
    const auto hierarchy = loadHierarchy(dataset, *manifest);
    EXPECT_TRUE(hierarchy.ok()) << hierarchy.error().message;
    const auto files = openPageFiles(dataset, *manifest);
    EXPECT_TRUE(files.ok());
    std::set<std::uint32_t> full;  // pages
    for (const LevelRecord& entry : hierarchy->entries) {
        for (std::uint32_t i = 0; entry.level == kFullLevel && i < entry.pageCount; ++i)
            full.insert(entry.firstPage + i);
    }
    for (const std::uint32_t page : full) {
        const PageRecord& record = hierarchy->pages[page];
        appendPage(*(*files)[record.file], record, triangles);
    }
    std::ranges::sort(triangles);
    return triangles;
}

std::vector<StoredTriangle> quantised(const std::vector<Triangle>& triangles, int stepExponent, bool colors,
                                      bool normals) {
    std::vector<StoredTriangle> result;
    for (const Triangle& triangle : triangles) {
        std::array<std::array<std::int64_t, 5>, 3> corners{};
        std::array<LatticePoint, 3> places;
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t a = 0; a < 3; ++a) {
                places[c][a] = static_cast<std::int64_t>(
                    std::nearbyint(std::ldexp(triangle[c].position[a], -stepExponent)));
                corners[c][a] = places[c][a];
            }
            corners[c][3] = colors ? triangle[c].color : 0;
            corners[c][4] = normals ? packNormal(triangle[c].normal) : 0;
        }
        if (places[0] == places[1] || places[1] == places[2] || places[2] == places[0]) continue;
        result.push_back(canonical(corners));
    }
    std::ranges::sort(result);
    return result;
}

Result<Manifest> buildFrom(const FakeInput& input, const std::string& output, const Chosen& chosen,
                           BuildParts parts) {
    NoProgress progress;
    BuildOptions options;
    options.memoryBytes = chosen.memoryBytes;
    options.leafTriangles = chosen.leafTriangles;
    options.stepExponent = chosen.stepExponent;
    options.threads = chosen.threads;
    options.inputs = {"fake.ply"};
    options.output = output;
    parts.openImporter = fakeImporters({{"fake.ply", input}});
    return buildDatasetFrom(options, progress, parts);
}

}  // namespace iwalk
