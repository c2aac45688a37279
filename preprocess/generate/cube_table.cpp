// Marching cubes (Lorensen and Cline, SIGGRAPH 1987), with a table that is derived instead of typed. On a
// face with four crossed edges inside corners are kept apart, which depends on the face alone: neighbours
// agree, and the surface is closed. Loops are triangulated without diagonals that lie in a face of the cube,
// so that no edge gets more than two triangles.
#include "preprocess/generate/cube_table.hpp"

#include "common/check.hpp"

namespace iwalk {
namespace {

using Loop = std::vector<std::uint8_t>;  // edges

constexpr std::array<std::array<unsigned, 4>, 6> kFaces{{
    // corners, counter-clockwise seen from outside the cube
    {0, 4, 6, 2},  // -x
    {1, 3, 7, 5},  // +x
    {0, 1, 5, 4},  // -y
    {2, 6, 7, 3},  // +y
    {0, 2, 3, 1},  // -z
    {4, 5, 7, 6},  // +z
}};

std::uint8_t edgeBetween(unsigned a, unsigned b) {
    for (unsigned edge = 0; edge < 12; ++edge) {
        const unsigned from = cubeEdge(edge).from, to = from + (1u << cubeEdge(edge).axis);
        if ((from == a && to == b) || (from == b && to == a)) return static_cast<std::uint8_t>(edge);
    }
    CHECK(false);
    return 0;
}

bool onFace(unsigned edge, const std::array<unsigned, 4>& face) {
    const unsigned from = cubeEdge(edge).from, to = from + (1u << cubeEdge(edge).axis);
    unsigned ends = 0;
    for (const unsigned corner : face) ends += corner == from || corner == to ? 1u : 0u;
    return ends == 2;
}

bool shareFace(unsigned a, unsigned b) {
    for (const auto& face : kFaces) {
        if (onFace(a, face) && onFace(b, face)) return true;
    }
    return false;
}

// For each crossed edge the one that follows it on its loop. On a face a segment cuts each run of inside
// corners off, from the edge that leads into the run to the one that leads out of it.
std::array<int, 12> followers(unsigned inside) {
    std::array<int, 12> next;
    next.fill(-1);
    const auto in = [&](unsigned corner) { return (inside >> corner & 1) != 0; };
    for (const auto& face : kFaces) {
        for (unsigned first = 0; first < 4; ++first) {
            if (in(face[first]) || !in(face[(first + 1) % 4])) continue;
            unsigned last = first + 1;
            while (in(face[(last + 1) % 4])) ++last;
            next[edgeBetween(face[first], face[(first + 1) % 4])] =
                edgeBetween(face[last % 4], face[(last + 1) % 4]);
        }
    }
    return next;
}

std::vector<Loop> loopsOf(unsigned inside) {
    std::array<int, 12> next = followers(inside);
    std::vector<Loop> loops;
    for (int start = 0; start < 12; ++start) {
        Loop loop;
        for (int edge = start; next[static_cast<unsigned>(edge)] >= 0;) {
            loop.push_back(static_cast<std::uint8_t>(edge));
            const int following = next[static_cast<unsigned>(edge)];
            next[static_cast<unsigned>(edge)] = -1;
            edge = following;
        }
        if (!loop.empty()) loops.push_back(loop);
    }
    return loops;
}

// Triangulates the corners first..last of the loop, whose side last-first is one already. False: impossible
// without a forbidden diagonal.
bool triangulate(const Loop& loop, std::size_t first, std::size_t last, std::vector<CubeTriangles>& out) {
    if (last - first < 2) return true;
    const auto allowed = [&](std::size_t a, std::size_t b) {
        return b - a == 1 || !shareFace(loop[a], loop[b]);
    };
    const std::size_t before = out.size();
    for (std::size_t middle = first + 1; middle < last; ++middle) {
        if (!allowed(first, middle) || !allowed(middle, last)) continue;
        if (triangulate(loop, first, middle, out) && triangulate(loop, middle, last, out)) {
            out.push_back({loop[first], loop[middle], loop[last]});
            return true;
        }
        out.resize(before);
    }
    return false;
}

}  // namespace

CubeTable makeCubeTable() {
    CubeTable table;
    for (unsigned inside = 0; inside < 256; ++inside) {
        for (const Loop& loop : loopsOf(inside)) {
            CubeCase& made = table[inside];
            CHECK(triangulate(loop, 0, loop.size() - 1, made.triangles));
            made.edges.insert(made.edges.end(), loop.begin(), loop.end());
        }
    }
    return table;
}

}  // namespace iwalk
