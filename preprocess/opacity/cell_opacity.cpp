#include "preprocess/opacity/cell_opacity.hpp"

#include <algorithm>
#include <bit>

#include "preprocess/opacity/clip.hpp"

namespace iwalk {
namespace {

using Masks = std::array<OpacityMask, kOpacityAxes>;

// Triangles between looks for masks that are full.
constexpr std::size_t kBatch = 256;

// False also when a coordinate is not a number.
bool insideCell(std::span<const glm::vec3, 3> triangle) {
    bool inside = true;
    for (const glm::vec3& p : triangle)
        inside &= (p.x >= 0) & (p.x <= 1) & (p.y >= 0) & (p.y <= 1) & (p.z >= 0) & (p.z <= 1);
    return inside;
}

// The cell itself: its sides, two triangles each.
Masks makeSilhouettes() {
    Masks masks{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const float plane : {0.0f, 1.0f}) {
            std::array<glm::vec3, 4> side;
            for (std::size_t i = 0; i < 4; ++i) {
                side[i][axis] = plane;
                side[i][(axis + 1) % 3] = i == 1 || i == 2 ? 1.0f : 0.0f;
                side[i][(axis + 2) % 3] = i >= 2 ? 1.0f : 0.0f;
            }
            coverPixels(std::array{side[0], side[1], side[2]}, kAllOpacityAxes, masks);
            coverPixels(std::array{side[0], side[2], side[3]}, kAllOpacityAxes, masks);
        }
    }
    return masks;
}

const Masks& silhouettes() {
    static const Masks masks = makeSilhouettes();
    return masks;
}

std::uint32_t pixels(const OpacityMask& mask, const OpacityMask& silhouette) {
    std::uint32_t count = 0;
    for (std::size_t y = 0; y < kOpacityPixels; ++y)
        count += static_cast<std::uint32_t>(std::popcount(mask[y] & silhouette[y]));
    return count;
}

std::uint8_t coefficient(std::uint32_t red, std::uint32_t lit) {
    if (red == 0) return 0;
    if (red == lit) return 255;
    return static_cast<std::uint8_t>(std::clamp((255 * red + lit / 2) / lit, 1u, 254u));
}

}  // namespace

void CellOpacity::clear() {
    masks_ = {};
    open_ = kAllOpacityAxes;
}

void CellOpacity::add(std::span<const glm::vec3> corners) {
    for (std::size_t i = 0; i + 2 < corners.size() && open_ != 0; i += 3) {
        if (i / 3 % kBatch == kBatch - 1) skipFullMasks();
        const auto triangle = corners.subspan(i).first<3>();
        if (insideCell(triangle)) {
            coverPixels(triangle, open_, masks_);
        } else {
            addClipped(triangle);
        }
    }
}

void CellOpacity::addClipped(std::span<const glm::vec3, 3> triangle) {
    const ClippedPolygon polygon = clipToCell(triangle);
    for (std::size_t i = 2; i < polygon.count; ++i)
        coverPixels(std::array{polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]}, open_,
                    masks_);
}

void CellOpacity::skipFullMasks() {
    for (std::size_t i = 0; i < kOpacityAxes; ++i) {
        bool full = true;
        for (std::size_t y = 0; y < kOpacityPixels; ++y)
            full = full && (silhouettes()[i][y] & ~masks_[i][y]) == 0;
        if (full) open_ &= ~(1u << i);
    }
}

std::array<std::uint8_t, kOpacityDirections> CellOpacity::coefficients() const {
    std::array<std::uint8_t, kOpacityDirections> result{};
    for (std::size_t i = 0; i < kOpacityAxes; ++i) {
        const OpacityMask& silhouette = silhouettes()[i];
        result[i] = coefficient(pixels(masks_[i], silhouette), pixels(silhouette, silhouette));
        result[i + kOpacityAxes] = result[i];
    }
    return result;
}

}  // namespace iwalk
