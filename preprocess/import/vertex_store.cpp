#include "preprocess/import/vertex_store.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "preprocess/import/vertex_output.hpp"

namespace iwalk {
namespace {

glm::dvec3 point(const VertexBatch& batch, VertexColumn first, std::size_t row) {
    const auto column = static_cast<std::size_t>(first);
    return glm::dvec3(batch.columns[column][row], batch.columns[column + 1][row],
                      batch.columns[column + 2][row]);
}

// NaN becomes 0.
std::uint8_t colorByte(double value) {
    return value > 0 ? static_cast<std::uint8_t>(std::lrint(std::min(value, 255.0))) : std::uint8_t{0};
}

}  // namespace

glm::vec3 unitOrZero(const glm::dvec3& v) {
    // Scaled first, so that the squares neither overflow nor vanish.
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!isFinite(v) || largest == 0) return glm::vec3(0);
    return glm::vec3(glm::normalize(glm::dvec3(v.x / largest, v.y / largest, v.z / largest)));
}

double largestCoordinate(const ModelBox& b) {
    if (b.empty()) return 0;
    return std::max({std::abs(b.min.x), std::abs(b.min.y), std::abs(b.min.z),  //
                     std::abs(b.max.x), std::abs(b.max.y), std::abs(b.max.z)});
}

double coordinateSpacing(const ModelBox& bounds, int bits) {
    const double largest = largestCoordinate(bounds);
    const int smallestExponent = bits == 23 ? -126 : -1022;  // below it spacing stays the same
    const int exponent = largest == 0 ? 0 : std::max(std::ilogb(largest), smallestExponent);
    return std::ldexp(1.0, exponent - bits);
}

double textPrecision(const ModelBox& bounds) {
    constexpr double kFarAway = 1024;
    const bool farAway = largestCoordinate(bounds) >= kFarAway * bounds.edge();
    return coordinateSpacing(bounds, farAway ? 52 : 23);
}

VertexStore::VertexStore(VertexFormat format, std::uint64_t memoryBytes, const std::string& spillDirectory)
    : format_(format), records_(format.bytes(), memoryBytes, spillDirectory) {}

Result<void> VertexStore::add(const VertexBatch& batch, const VertexSink& sink) {
    positions_.clear();
    for (std::size_t row = 0; row < batch.rows; ++row) {
        ASSIGN_OR_RETURN(std::byte* const record, records_.append());
        encode(batch, row, record);
        // As kept: a double beyond the range of float is infinite as a float.
        Corner kept;
        decode(record, kept);
        if (!isFinite(kept.position)) continue;
        bounds_.add(kept.position);
        positions_.push_back(kept.position);
    }
    finite_ += positions_.size();
    if (sink && !positions_.empty()) sink(positions_);
    return {};
}

void VertexStore::encode(const VertexBatch& batch, std::size_t row, std::byte* record) const {
    const glm::dvec3 position = point(batch, kX, row);
    if (format_.doubles) {
        std::memcpy(record, &position, sizeof position);
    } else {
        const glm::vec3 narrow(position);
        std::memcpy(record, &narrow, sizeof narrow);
    }
    if (format_.colors) {
        std::array<std::uint8_t, 4> rgba{};
        for (std::size_t i = 0; i < 4; ++i) rgba[i] = colorByte(batch.columns[kRed + i][row]);
        std::memcpy(record + format_.colorOffset(), rgba.data(), rgba.size());
    }
    if (format_.normals) {
        const glm::vec3 normal = unitOrZero(point(batch, kNormalX, row));
        std::memcpy(record + format_.normalOffset(), &normal, sizeof normal);
    }
}

}  // namespace iwalk
