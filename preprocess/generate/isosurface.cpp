// Marching cubes, a slab of cells at a time. The first pass computes the field, writes the vertices and keeps
// the signs in a spill file (3 to 4 % of the result's size); the second writes the triangles from the signs
// alone. Both number vertices in the same order: slab by slab, first the edges within a slab of points, then
// those to the next.
#include "preprocess/generate/isosurface.hpp"

#include <algorithm>

#include "preprocess/generate/isosurface_size.hpp"
#include "preprocess/generate/mixing_field.hpp"
#include "preprocess/generate/surface_cells.hpp"
#include "preprocess/import/spill_file.hpp"

namespace iwalk {
namespace {

// Vertices keep this share of an edge away from its ends: no triangle degenerates.
constexpr float kEndMargin = 0.05f;

// Colours from the layer's bottom to its top.
constexpr std::array<Rgb, 6> kRamp{
    {{24, 42, 110}, {38, 110, 172}, {120, 190, 200}, {238, 226, 190}, {226, 140, 62}, {150, 44, 28}}};

Rgb colorAt(float z) {
    constexpr float kScale = static_cast<float>(kRamp.size() - 1) / static_cast<float>(2 * kLayerHalfHeight);
    // The middle half of the layer has most of the surface.
    const float stretched = (z * 1.5f + static_cast<float>(kLayerHalfHeight)) * kScale;
    const float at = std::clamp(stretched, 0.0f, static_cast<float>(kRamp.size()) - 1.001f);
    const auto i = static_cast<std::size_t>(at);
    Rgb color{};
    for (std::size_t c = 0; c < 3; ++c) {
        const float a = kRamp[i][c], b = kRamp[i + 1][c];
        color[c] = static_cast<std::uint8_t>(a + (b - a) * (at - static_cast<float>(i)) + 0.5f);
    }
    return color;
}

// Field and signs at the points of one x.
struct Slab {
    std::vector<float> values;
    Signs signs;
};

// A row's word of points.
struct Place {
    std::size_t x = 0, z = 0, word = 0;
};

class VertexPass {
  public:
    VertexPass(const IsosurfaceGrid& grid, PlyOutput& output)
        : grid_(grid), output_(output), within_(grid), between_(grid) {}

    // The vertices on edges that start at the points of slab x.
    void slab(std::uint32_t x, const Slab& at, const Slab* next) {
        findSlabEdges(grid_, at.signs, within_, 0);
        forWords(x, [&](const Place& place, std::size_t first) {
            const float* values = &at.values[first];
            edges(within_.y.crossed(place.z, place.word), place, 1, values, values + 1);
            edges(within_.z.crossed(place.z, place.word), place, 2, values, values + grid_.stride());
        });
        if (next == nullptr) return;
        findEdgesBetween(grid_, at.signs, next->signs, between_, 0);
        forWords(x, [&](const Place& place, std::size_t first) {
            edges(between_.crossed(place.z, place.word), place, 0, &at.values[first], &next->values[first]);
        });
    }

  private:
    // Calls f(place, index of its first point in the slab) in the order of vertices.
    template <class F>
    void forWords(std::size_t x, F&& f) const {
        for (std::size_t z = 0; z < grid_.rows(); ++z) {
            for (std::size_t word = 0; word < grid_.words(); ++word) {
                f(Place{x, z, word}, z * grid_.stride() + word * 64);
            }
        }
    }
    // `from`, `to`: the field where the word's edges start and end.
    void edges(std::uint64_t crossed, const Place& place, std::size_t axis, const float* from,
               const float* to) {
        for (; crossed != 0; crossed &= crossed - 1) {
            const auto bit = static_cast<std::size_t>(std::countr_zero(crossed));
            const float along = std::clamp(from[bit] / (from[bit] - to[bit]), kEndMargin, 1 - kEndMargin);
            std::array<double, 3> at{static_cast<double>(place.x), static_cast<double>(place.word * 64 + bit),
                                     static_cast<double>(place.z)};
            at[axis] += static_cast<double>(along);
            const glm::vec3 position{static_cast<float>(at[0] * grid_.step()),
                                     static_cast<float>(at[1] * grid_.step()),
                                     static_cast<float>(at[2] * grid_.stepZ() - kLayerHalfHeight)};
            output_.vertex(position, colorAt(position.z));
        }
    }

    IsosurfaceGrid grid_;
    PlyOutput& output_;
    SlabEdges within_;
    CrossedEdges between_;
};

class TrianglePass {
  public:
    TrianglePass(const IsosurfaceGrid& grid, PlyOutput& output)
        : grid_(grid), output_(output), within_{SlabEdges(grid), SlabEdges(grid)}, between_(grid) {}

    void first(const Signs& signs) { next_ = findSlabEdges(grid_, signs, within_[0], 0); }
    // The cells between slab x, with signs `a`, and the next one, with signs `b`.
    void slab(std::uint32_t x, const Signs& a, const Signs& b) {
        SlabEdges &near = within_[x % 2], &far = within_[(x + 1) % 2];
        next_ = findEdgesBetween(grid_, a, b, between_, next_);
        next_ = findSlabEdges(grid_, b, far, next_);
        const std::array<std::array<const CrossedEdges*, 2>, 3> edges{
            {{&between_, &between_}, {&near.y, &far.y}, {&near.z, &far.z}}};
        std::array<std::uint32_t, 12> vertices{};  // by edge of the cell
        forCrossedCells(grid_, a, b, [&](std::size_t y, std::size_t z, unsigned inside) {
            const CubeCase& found = table_[inside];
            for (const std::uint8_t edge : found.edges) {
                const CubeEdge at = cubeEdge(edge);
                vertices[edge] =
                    edges[at.axis][at.from & 1]->vertex(z + (at.from >> 2), y + (at.from >> 1 & 1));
            }
            for (const auto& [p, q, r] : found.triangles) {
                output_.triangle(vertices[p], vertices[q], vertices[r]);
            }
        });
    }

  private:
    IsosurfaceGrid grid_;
    PlyOutput& output_;
    CubeTable table_ = makeCubeTable();
    std::array<SlabEdges, 2> within_;
    CrossedEdges between_;
    std::uint32_t next_ = 0;  // vertex
};

Result<void> writeVertices(const IsosurfaceGrid& grid, std::uint64_t seed, PlyOutput& output,
                           SpillFile& spill, Progress& progress) {
    MixingField field(seed, grid);
    VertexPass pass(grid, output);
    std::array<Slab, 2> slabs;
    for (Slab& slab : slabs) slab.values.resize(grid.rows() * grid.stride());
    for (std::uint32_t x = 0; x <= grid.cells; ++x) {
        Slab& slab = slabs[x % 2];
        field.slab(x, slab.values);
        findSigns(grid, slab.values, slab.signs);
        const auto bytes = std::as_bytes(std::span(slab.signs));
        RETURN_IF_ERROR(spill.writeAt(x * bytes.size(), bytes));
        if (x > 0) pass.slab(x - 1, slabs[(x - 1) % 2], &slab);
        if (x == grid.cells) pass.slab(x, slab, nullptr);
        RETURN_IF_ERROR(output.status());
        progress.done(static_cast<double>(x) / grid.cells);
    }
    return {};
}

Result<void> writeTriangles(const IsosurfaceGrid& grid, PlyOutput& output, const SpillFile& spill,
                            Progress& progress) {
    TrianglePass pass(grid, output);
    std::array<Signs, 2> signs;
    for (std::uint32_t x = 0; x <= grid.cells; ++x) {
        Signs& to = signs[x % 2];
        to.resize(grid.rows() * grid.words());
        const auto bytes = std::as_writable_bytes(std::span(to));
        RETURN_IF_ERROR(spill.readAt(x * bytes.size(), bytes));
        if (x == 0) pass.first(to);
        if (x > 0) pass.slab(x - 1, signs[(x - 1) % 2], to);
        RETURN_IF_ERROR(output.status());
        progress.done(static_cast<double>(x) / grid.cells);
    }
    return {};
}

}  // namespace

Result<void> generateIsosurface(std::uint64_t triangles, std::uint64_t seed, PlyOutput& output,
                                const std::string& spillDirectory, Progress& progress) {
    progress.phase("choosing the grid");
    const IsosurfaceGrid grid = findIsosurfaceGrid(triangles, seed, progress);
    ASSIGN_OR_RETURN(const std::unique_ptr<SpillFile> spill, SpillFile::create(spillDirectory));
    progress.phase("vertices");
    RETURN_IF_ERROR(writeVertices(grid, seed, output, *spill, progress));
    progress.phase("triangles");
    return writeTriangles(grid, output, *spill, progress);
}

}  // namespace iwalk
