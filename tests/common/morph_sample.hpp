#pragma once

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstring>
#include <random>

#include "common/dataset/morph.hpp"

namespace iwalk {

inline const LatticePoint kLowest(-7, 5, std::int64_t{1} << 40);
inline constexpr std::uint32_t kFarthest = 0xffffffff;

// What of a sample's vertices goes where.
enum class Targets { kStay, kVertices, kVerticesAndExtras, kExtras };

// A fan of triangles in two ranges, and where its vertices go: within 2^bits steps of kLowest.
struct MorphSample {
    MorphSample(std::uint32_t triangles, int bits, Targets kind) : mask((std::int64_t{1} << bits) - 1) {
        for (std::uint32_t v = 0; v < triangles + 2; ++v) positions.push_back(somewhere());
        // Pages may have several vertices in one place.
        if (triangles > 10) positions[9] = positions[5];
        targets = positions;
        for (std::uint32_t v = 0; v < targets.size(); ++v) target(v, kind);
        for (std::uint32_t t = 0; t < triangles; ++t) {
            for (const std::uint32_t v : {0u, t + 1, t + 2}) indices.push_back(static_cast<std::uint16_t>(v));
        }
        const std::uint32_t half = triangles / 2 * 3;
        const auto edge = static_cast<std::uint32_t>(mask);
        table.origin = kLowest;
        table.ranges = {{0, half, kRootPath, {0, 0, 0}, {edge, edge, edge}},
                        {half, 3 * triangles - half, kRootPath, {1, 0, 0}, {edge, edge, kFarthest}}};
        record.bytes = 1000;
        record.vertexCount = triangles + 2;
        record.indexCount = 3 * triangles;
        record.rangeCount = 2;
        encode();
    }

    void encode() {
        record.flags = record.morphBytes = 0;
        bytes = encodeMorph({table.origin, positions, targets, table.ranges, indices}, record);
    }
    LatticePoint somewhere() {
        LatticePoint point;
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            point[axis] = kLowest[axis] + (static_cast<std::int64_t>(random()) & mask);
        }
        return point;
    }
    void target(std::uint32_t v, Targets kind) {
        const bool extra = kind == Targets::kExtras || (kind == Targets::kVerticesAndExtras && v % 4 == 3);
        if (kind == Targets::kStay || v % 3 == 1) return;
        targets[v] = extra ? somewhere() : positions[random() % positions.size()];
    }
    // Writes a stream in the place of that of record `stream`, the last one of the block.
    void replaceLast(std::size_t stream, std::span<const std::byte> coded) {
        bytes.resize(get(stream));
        bytes.insert(bytes.end(), coded.begin(), coded.end());
        put(stream + 4, static_cast<std::uint32_t>(coded.size()));
        record.morphBytes = static_cast<std::uint32_t>(bytes.size());
    }
    template <class T>
    void put(std::size_t place, T value) {
        std::memcpy(bytes.data() + place, &value, sizeof(value));
    }
    std::uint32_t get(std::size_t place) const {
        std::uint32_t value = 0;
        std::memcpy(&value, bytes.data() + place, sizeof(value));
        return value;
    }
    // Checksums of what there is now.
    void seal() {
        for (const std::size_t stream : {48u, 64u, 80u}) {
            const std::size_t offset = get(stream), size = get(stream + 4);
            if (size == 0 || offset > bytes.size() || size > bytes.size() - offset) continue;
            put(stream + 8, XXH64(bytes.data() + offset, size, 0));
        }
        put(kMorphHeaderBytes - 8, XXH64(bytes.data(), kMorphHeaderBytes - 8, 0));
    }
    Result<PageMorph> decoded() const { return decodeMorph(bytes, record, table); }

    std::mt19937_64 random{5};
    std::int64_t mask;
    std::vector<LatticePoint> positions, targets;
    std::vector<std::uint16_t> indices;
    PageTable table;
    PageRecord record{};
    std::vector<std::byte> bytes;
};

}  // namespace iwalk
