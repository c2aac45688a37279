#include "preprocess/opacity/raster.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

// Edge functions (Pineda 1988, "A parallel algorithm for polygon rasterization"), set up for all views at
// once in vectors of one lane a view. Everything behind the snapping to subpixels is exact in 32-bit
// integers, and snapping is single precision without contraction, so the processor's vector width does not
// change results.
namespace iwalk {
namespace {

constexpr std::int32_t kPixel = 1 << kSubpixelBits;
constexpr std::int32_t kHalfPixel = kPixel / 2;
// Rows narrower than this are tested pixel by pixel; in wider ones the ends of the span are computed.
constexpr std::int32_t kWideRow = 12;

// Four views side by side: what every 64-bit processor has.
using Ints [[gnu::vector_size(4 * kOpacityLanes)]] = std::int32_t;
using Floats [[gnu::vector_size(4 * kOpacityLanes)]] = float;

// Inside the triangle where all three functions are >= 0. `value` is at the centre of the box's first pixel.
struct EdgeLanes {
    Ints value, stepX, stepY;
};

// A triangle in some views.
struct TriangleLanes {
    Ints minX, maxX, minY, maxY;  // pixels whose centres are in its box; min > max: none
    std::array<EdgeLanes, 3> edges;
};

inline Ints project(const OpacityViews::Rows& rows, const glm::vec3& p) {
    std::array<Floats, 4> row;
    static_assert(sizeof(row) == sizeof(rows));
    std::memcpy(&row, &rows, sizeof(row));
    return __builtin_convertvector(row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3], Ints);
}

// The first and last pixels whose centres lie in the closed interval of three coordinates.
inline void bound(const std::array<Ints, 3>& v, Ints& min, Ints& max) {
    Ints low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];
    low = v[2] < low ? v[2] : low;
    high = v[2] > high ? v[2] : high;
    min = (low + (kHalfPixel - 1)) >> kSubpixelBits;
    max = (high - kHalfPixel) >> kSubpixelBits;
}

// The edge from corner a to corner b of triangles that turn left where side is 0, right where it is -1.
inline void setEdge(const std::array<Ints, 3>& x, const std::array<Ints, 3>& y, std::size_t a, std::size_t b,
                    Ints side, TriangleLanes& t) {
    const Ints dx = ((x[b] - x[a]) ^ side) - side, dy = ((y[b] - y[a]) ^ side) - side;
    const Ints px = t.minX * kPixel + kHalfPixel - x[a], py = t.minY * kPixel + kHalfPixel - y[a];
    // A centre on the edge moves inside when it goes a little to the right (dy < 0), and up by less. True is
    // -1 in a lane.
    const Ints outside = (dy > 0) | ((dy == 0) & (dx <= 0));
    t.edges[a] = {dx * py - dy * px + outside, -dy * kPixel, dx * kPixel};
}

// Bit i of the result: lane i is true.
inline std::uint32_t laneBits(Ints truth) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kOpacityLanes; ++i) bits |= static_cast<std::uint32_t>(truth[i]) & (1u << i);
    return bits;
}

// Bit i: view i has a centre in the box of a triangle that is not degenerate.
inline std::uint32_t setUp(const OpacityViews& views, std::span<const glm::vec3, 3> triangle,
                           TriangleLanes& t) {
    std::array<Ints, 3> x, y;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        x[corner] = project(views.x, triangle[corner]);
        y[corner] = project(views.y, triangle[corner]);
    }
    bound(x, t.minX, t.maxX);
    bound(y, t.minY, t.maxY);
    const Ints area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    const std::uint32_t seen = laneBits((t.minX <= t.maxX) & (t.minY <= t.maxY) & (area != 0));
    if (seen == 0) return 0;
    const Ints side = area < 0;
    setEdge(x, y, 0, 1, side, t);
    setEdge(x, y, 1, 2, side, t);
    setEdge(x, y, 2, 0, side, t);
    return seen;
}

// One edge function in one view, at the first pixel of a row.
struct Edge {
    std::int32_t value, stepX, stepY;
};

// Bits [first, last] of [0, count) where the function is >= 0: narrows them.
void narrow(const Edge& edge, std::int32_t& first, std::int32_t& last) {
    if (edge.value < 0) {
        if (edge.stepX <= 0) {
            last = -1;
        } else {
            first = std::max(first, (-edge.value + edge.stepX - 1) / edge.stepX);
        }
    } else if (edge.stepX < 0) {
        last = std::min(last, edge.value / -edge.stepX);
    }
}

std::uint64_t wideRow(const std::array<Edge, 3>& edges, std::int32_t count) {
    std::int32_t first = 0, last = count - 1;
    for (const Edge& edge : edges) narrow(edge, first, last);
    if (first > last) return 0;
    return (~std::uint64_t{0} >> (63 - (last - first))) << first;
}

std::uint64_t narrowRow(const std::array<Edge, 3>& edges, std::int32_t count) {
    std::uint64_t bits = 0;
    std::int32_t a = edges[0].value, b = edges[1].value, c = edges[2].value;
    for (std::int32_t x = 0; x < count; ++x) {
        bits |= static_cast<std::uint64_t>((a | b | c) >= 0) << x;
        a += edges[0].stepX, b += edges[1].stepX, c += edges[2].stepX;
    }
    return bits;
}

void fill(const TriangleLanes& t, std::size_t lane, OpacityMask& mask) {
    std::array<Edge, 3> edges;
    for (std::size_t e = 0; e < 3; ++e)
        edges[e] = {t.edges[e].value[lane], t.edges[e].stepX[lane], t.edges[e].stepY[lane]};
    const std::int32_t columns = t.maxX[lane] - t.minX[lane] + 1;
    for (std::int32_t y = t.minY[lane]; y <= t.maxY[lane]; ++y) {
        const std::uint64_t bits = columns < kWideRow ? narrowRow(edges, columns) : wideRow(edges, columns);
        mask[static_cast<std::size_t>(y)] |= bits << t.minX[lane];
        for (Edge& edge : edges) edge.value += edge.stepY;
    }
}

}  // namespace

void coverPixels(std::span<const glm::vec3, 3> triangle, std::uint32_t axes,
                 std::array<OpacityMask, kOpacityAxes>& masks) {
    const std::array<OpacityViews, kOpacityGroups>& views = opacityViews();
    for (std::size_t group = 0; group < kOpacityGroups; ++group) {
        const std::size_t first = group * kOpacityLanes;
        TriangleLanes t;
        std::uint32_t todo = setUp(views[group], triangle, t) & (axes >> first);
        for (; todo != 0; todo &= todo - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(todo));
            fill(t, lane, masks[first + lane]);
        }
    }
}

}  // namespace iwalk
