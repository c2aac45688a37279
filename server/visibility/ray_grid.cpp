#include "server/visibility/ray_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>

namespace iwalk {
namespace {

constexpr std::size_t kPacket = 8;           // rays that are tested against a box at once
constexpr int kBands = 8;                    // more spread better over threads and repeat more for each box
constexpr std::size_t kTogether = 512;       // boxes whose cells a thread finds at a time
constexpr float kLeastContribution = 1e-6f;  // so that what lies far behind still has an order
constexpr float kLeastSide = 0.01f;          // cells: of a box that is seen edge-on

using Packet = std::array<float, kPacket>;
constexpr Packet kPlaces{0, 1, 2, 3, 4, 5, 6, 7};

// A number in [0, 1) that depends on `n` alone (the finaliser of MurmurHash3).
double jitter(std::uint32_t n) {
    n ^= n >> 16, n *= 0x85ebca6bu, n ^= n >> 13, n *= 0xc2b2ae35u, n ^= n >> 16;
    return static_cast<double>(n) * 0x1p-32;
}

int cellsAlong(int pixels, double raysPerPixel) {
    return std::max(1, static_cast<int>(std::lround(pixels * std::sqrt(raysPerPixel))));
}

// A direction that is 0 along an axis would make 0 * infinity of a box's side; products with any lattice
// distance stay finite.
float inverseOf(double d) {
    constexpr double kLeast = 1e-18;
    return static_cast<float>(1 / (std::abs(d) < kLeast ? std::copysign(kLeast, d) : d));
}

// By value, so that loops of them become vector instructions.
float least(float a, float b) {
    return a < b ? a : b;
}
float greatest(float a, float b) {
    return a > b ? a : b;
}

// About exp(-x) for x >= 0, of operations that have vector instructions: at most 2 % off where more than a
// thousandth is left.
float fading(float x) {
    const float t = x / 8;
    const float once = 1 / (1 + t * (1 + t * (0.5f + t / 6)));
    const float twice = once * once, four = twice * twice;
    return four * four;
}

// In an order that does not depend on the compiler's vectors.
float sumOf(const Packet& p) {
    return ((p[0] + p[4]) + (p[1] + p[5])) + ((p[2] + p[6]) + (p[3] + p[7]));
}

}  // namespace

RayGrid::RayGrid(const ScreenProjection& projection, const PixelRect& tile, double near, double raysPerPixel)
    : columns_(cellsAlong(tile.width, raysPerPixel)),
      rows_(cellsAlong(tile.height, raysPerPixel)),
      stride_(static_cast<std::size_t>(columns_) + kPacket),
      near_(static_cast<float>(near)) {
    const double width = double(tile.width) / columns_, height = double(tile.height) / rows_;  // px
    glm::dmat3 fromPixels(1);
    fromPixels[0].x = 1 / width, fromPixels[1].y = 1 / height;
    fromPixels[2] = glm::dvec3(-tile.x / width, -tile.y / height, 1);
    toGrid_ = glm::mat3(fromPixels * projection.toPixels);

    for (std::vector<float>& inverse : inverse_) inverse.assign(firstOf(rows_), 0);
    length_.assign(firstOf(rows_), 0);
    contribution_.assign(firstOf(rows_), 1);
    std::uint32_t random = 0;
    for (int row = 0; row < rows_; ++row)
        for (int column = 0; column < columns_; ++column) {
            const double x = tile.x + (column + jitter(random++)) * width;
            const double y = tile.y + (row + jitter(random++)) * height;
            const glm::dvec3 direction = projection.toDirection * glm::dvec3(x, y, 1);
            const std::size_t ray = firstOf(row) + static_cast<std::size_t>(column);
            for (std::size_t axis = 0; axis < 3; ++axis) inverse_[axis][ray] = inverseOf(direction[axis]);
            length_[ray] = static_cast<float>(glm::length(direction));
        }
}

std::vector<RayGrid::Arrival> RayGrid::cross(std::span<const Pass> boxes, Workers& workers) {
    std::vector<Cells> cells(boxes.size());
    workers.runParts(boxes.size(), kTogether, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) cells[i] = cellsOf(boxes[i].box);
    });

    // Each band of rows goes through all boxes. What lies in several bands is added up later.
    struct Part {
        std::size_t box;
        Met met;
    };
    const int bands = std::min(kBands, rows_);
    std::vector<std::vector<Part>> parts(static_cast<std::size_t>(bands));
    std::vector<Met> met(boxes.size());
    workers.run(parts.size(), [&](std::size_t band) {
        const int top = rows_ * static_cast<int>(band) / bands,
                  bottom = rows_ * static_cast<int>(band + 1) / bands;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Cells& c = cells[i];
            if (c.top >= top && c.bottom <= bottom)
                met[i] = crossRows(boxes[i], c, c.top, c.bottom);
            else if (c.top < bottom && c.bottom > top)
                parts[band].push_back(
                    {i, crossRows(boxes[i], c, std::max(top, c.top), std::min(bottom, c.bottom))});
        }
    });
    for (const std::vector<Part>& band : parts)
        for (const Part& part : band) met[part.box].add(part.met);

    std::vector<Arrival> arrivals;
    arrivals.reserve(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const Cells& c = cells[i];
        const auto count = static_cast<float>((c.right - c.left) * (c.bottom - c.top));
        const float between = met[i].around / count * std::min(c.area, 1.0f);
        arrivals.push_back(met[i].arrival.rays > 0 ? met[i].arrival : Arrival{0, between});
    }
    return arrivals;
}

// The cells that the box's rectangle meets; all of them when the box is not all in front of the eye.
RayGrid::Cells RayGrid::cellsOf(const EyeBox& box) const {
    // Eight corners at once.
    const glm::vec3 start = toGrid_ * box.low, sides = box.high - box.low;
    const glm::vec3 x = toGrid_[0] * sides.x, y = toGrid_[1] * sides.y, z = toGrid_[2] * sides.z;
    Packet places[2], depth;
    for (std::size_t i = 0; i < kPacket; ++i) {
        const float inX = i & 1 ? 1.0f : 0.0f, inY = i & 2 ? 1.0f : 0.0f, inZ = i & 4 ? 1.0f : 0.0f;
        depth[i] = start.z + inX * x.z + inY * y.z + inZ * z.z;
        places[0][i] = (start.x + inX * x.x + inY * y.x + inZ * z.x) / depth[i];
        places[1][i] = (start.y + inX * x.y + inY * y.y + inZ * z.y) / depth[i];
    }
    const auto nearest = *std::min_element(depth.begin(), depth.end());
    if (!(nearest > near_)) return {0, columns_, 0, rows_, 1};

    const float ends[2] = {static_cast<float>(columns_), static_cast<float>(rows_)};
    float low[2], high[2];
    for (std::size_t axis = 0; axis < 2; ++axis) {
        Packet& place = places[axis];
        Packet farthest = place;
        for (std::size_t half = kPacket / 2; half > 0; half /= 2)
            for (std::size_t i = 0; i < half; ++i) {
                place[i] = least(place[i], place[i + half]);
                farthest[i] = greatest(farthest[i], farthest[i + half]);
            }
        low[axis] = least(greatest(place[0], 0), ends[axis]);
        high[axis] = least(greatest(farthest[0], 0), ends[axis]);
    }
    const int left = std::min(static_cast<int>(low[0]), columns_ - 1),
              top = std::min(static_cast<int>(low[1]), rows_ - 1);
    return {left, std::max(left + 1, static_cast<int>(std::ceil(high[0]))), top,
            std::max(top + 1, static_cast<int>(std::ceil(high[1]))),
            greatest(high[0] - low[0], kLeastSide) * greatest(high[1] - low[1], kLeastSide)};
}

RayGrid::Met RayGrid::crossRows(const Pass& pass, const Cells& cells, int top, int bottom) {
    const EyeBox& box = pass.box;
    Packet rays{}, arriving{};
    for (int row = top; row < bottom; ++row)
        for (int column = cells.left; column < cells.right; column += static_cast<int>(kPacket)) {
            const std::size_t first = firstOf(row) + static_cast<std::size_t>(column);
            const auto count = static_cast<float>(cells.right - column);
            const float *const x = &inverse_[0][first], *const y = &inverse_[1][first],
                               *const z = &inverse_[2][first], *const length = &length_[first];
            float* const contribution = &contribution_[first];
            Packet inside, hits;
            for (std::size_t i = 0; i < kPacket; ++i) {
                const float x0 = box.low.x * x[i], x1 = box.high.x * x[i];
                const float y0 = box.low.y * y[i], y1 = box.high.y * y[i];
                const float z0 = box.low.z * z[i], z1 = box.high.z * z[i];
                const float enter =
                    greatest(greatest(least(x0, x1), least(y0, y1)), greatest(least(z0, z1), near_));
                const float leave = least(least(greatest(x0, x1), greatest(y0, y1)), greatest(z0, z1));
                inside[i] = leave - enter;
                hits[i] = (leave >= enter ? 1.0f : 0.0f) * (kPlaces[i] < count ? 1.0f : 0.0f);
            }
            for (std::size_t i = 0; i < kPacket; ++i) {
                rays[i] += hits[i];
                arriving[i] += hits[i] * contribution[i];
            }
            if (pass.density <= 0) continue;
            for (std::size_t i = 0; i < kPacket; ++i) {
                const float left = contribution[i] * fading(pass.density * (inside[i] * length[i]));
                contribution[i] = hits[i] > 0 ? greatest(left, kLeastContribution) : contribution[i];
            }
        }
    Met met{{sumOf(rays), sumOf(arriving)}, 0};
    if (met.arrival.rays > 0) return met;
    for (int row = top; row < bottom; ++row)
        for (int column = cells.left; column < cells.right; ++column)
            met.around += contribution_[firstOf(row) + static_cast<std::size_t>(column)];
    return met;
}

}  // namespace iwalk
