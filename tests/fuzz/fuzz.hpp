#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/file.hpp"
#include "preprocess/import/importer.hpp"

// Each target is a program of plain_main.cpp or, with the preset `fuzz`, one of libFuzzer's. It has these two
// functions.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
namespace iwalk {
// Inputs to begin with, good ones.
std::vector<std::string> fuzzSeeds();

class MemoryFile : public RandomAccessFile {
  public:
    MemoryFile(const std::uint8_t* data, std::size_t size) : bytes_(std::as_bytes(std::span(data, size))) {}
    Result<void> readAt(std::uint64_t offset, std::span<std::byte> out) const override {
        if (offset > bytes_.size() || out.size() > bytes_.size() - offset)
            return fail("memory: ends at {}", offset);
        if (!out.empty()) std::memcpy(out.data(), bytes_.data() + offset, out.size());
        return {};
    }
    std::uint64_t size() const override { return bytes_.size(); }

  private:
    std::span<const std::byte> bytes_;
};

// Reads all there is, twice, and checks what an importer promises. Returns what came of it.
inline std::string readAll(const Result<std::unique_ptr<Importer>>& opened) {
    if (!opened) {
        CHECK(opened.error().message.find('\n') == std::string::npos);
        return opened.error().message;
    }
    Importer& importer = **opened;
    const auto summary = importer.scan([](std::span<const glm::dvec3>) {}, {});
    if (!summary) return summary.error().message;
    std::uint64_t triangles = 0;
    const auto counts = importer.triangles(
        [&](std::span<const Triangle> batch) {
            for (const Triangle& triangle : batch) {
                for (const Corner& corner : triangle) {
                    const glm::dvec3& p = corner.position;
                    CHECK(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
                    CHECK(summary->normals || corner.normal == glm::vec3(0));
                }
            }
            triangles += batch.size();
            return Result<void>();
        },
        {});
    if (!counts) return counts.error().message;
    CHECK_OP(counts->triangles, ==, triangles);
    CHECK(summary->triangleBound == 0 || counts->triangles <= summary->triangleBound);
    return fmt::format("{} vertices, {} triangles, {} dropped", summary->vertices, triangles,
                       counts->droppedNonFinite);
}

// Where what does not fit in memory goes; the limits are the least there may be.
inline ImportLimits fuzzLimits() {
    return {std::uint64_t{16} << 20, "/tmp"};
}

// Reads it as it is and, which must not make a difference, cut into blocks of a few bytes.
template <class Open>
void readInBlocks(const Open& open, std::size_t size) {
    ImportLimits limits = fuzzLimits();
    const std::string whole = readAll(open(limits));
    limits.blockBytes = 1 + size % 61;
    const std::string cut = readAll(open(limits));
    CHECK_OP(cut, ==, whole);
}

}  // namespace iwalk
