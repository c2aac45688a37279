#include "preprocess/build/page_job.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "preprocess/build/grid.hpp"
#include "preprocess/build/order.hpp"

namespace iwalk {
namespace {

// Gives equal vertices one number: a flat hash table with linear probing.
class Welder {
  public:
    Welder(std::vector<PageVertex>& vertices, std::size_t most)
        : vertices_(vertices), table_(std::bit_ceil(2 * most), kFree), mask_(table_.size() - 1) {}

    std::uint32_t add(const PageVertex& vertex) {
        for (std::size_t slot = hash(vertex) & mask_;; slot = (slot + 1) & mask_) {
            if (table_[slot] == kFree) {
                table_[slot] = static_cast<std::uint32_t>(vertices_.size());
                vertices_.push_back(vertex);
                return table_[slot];
            }
            if (vertices_[table_[slot]] == vertex) return table_[slot];
        }
    }

  private:
    static constexpr std::uint32_t kFree = 0xffffffff;
    static std::size_t hash(const PageVertex& v) {
        std::uint64_t h = (v.offset[0] | std::uint64_t{v.offset[1]} << 32) * 0x9e3779b97f4a7c15u;
        h = (h ^ h >> 29 ^ v.offset[2] ^ std::uint64_t{v.color} << 32) * 0xbf58476d1ce4e5b9u;
        h = (h ^ h >> 32 ^ v.normal) * 0x94d049bb133111ebu;
        return static_cast<std::size_t>(h ^ h >> 31);
    }
    std::vector<PageVertex>& vertices_;
    std::vector<std::uint32_t> table_;
    std::size_t mask_;
};

class Builder {
  public:
    Builder(const PageJob& job, const Lattice& lattice, const RecordFormat& format, std::uint32_t attributes)
        : job_(job), format_(format) {
        page_.attributes = attributes;
        origin_ = lowestCorner(lattice);
        page_.origin = lattice.fromCell(origin_);
    }

    BuiltPage run() {
        weld();
        for (std::size_t s = 0, next = 0; s < job_.slices.size(); s = next) {
            std::size_t triangles = 0;
            for (; next < job_.slices.size() && job_.slices[next].node == job_.slices[s].node; ++next) {
                triangles += job_.slices[next].count;
            }
            addRanges(s, next, triangles);
        }
        reorderVertices();
        BuiltPage built;
        built.nodes = std::move(nodes_);
        built.errors = std::move(errors_);
        built.bytes = encodePage(page_, built.record);
        return built;
    }

  private:
    // Of these very triangles, and the boxes that their ranges must have: a slice's box may be larger, by how
    // the triangles happened to come.
    CellPoint lowestCorner(const Lattice& lattice) {
        CellPoint lowest(std::numeric_limits<std::uint64_t>::max());
        for (const Slice& slice : job_.slices) {
            triangles_ += slice.count;
            for (const Run& run : slice.runs) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const std::int64_t value = run.box.min[axis] - lattice.rootCell[axis];
                    lowest[axis] = std::min(lowest[axis], static_cast<std::uint64_t>(value));
                }
            }
            for (std::size_t i = 0; i < slice.count; ++i) {
                const std::uint32_t* record = slice.record(i, format_.words());
                for (std::size_t corner = 0; corner < 3; ++corner) {
                    const CellPoint p = format_.position(record, corner);
                    for (std::size_t axis = 0; axis < 3; ++axis)
                        lowest[axis] = std::min(lowest[axis], p[axis]);
                }
            }
        }
        return lowest;
    }

    PageVertex vertexOf(const std::uint32_t* record, std::size_t corner) const {
        const CellPoint position = format_.position(record, corner);
        PageVertex vertex{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            vertex.offset[axis] = static_cast<std::uint32_t>(position[axis] - origin_[axis]);
        }
        vertex.color = format_.color(record, corner);
        vertex.normal = format_.normal(record, corner);
        return vertex;
    }

    void weld() {
        Welder welder(page_.vertices, 3 * triangles_);
        indices_.reserve(3 * triangles_);
        keys_.reserve(triangles_);
        for (const Slice& slice : job_.slices) {
            for (std::size_t i = 0; i < slice.count; ++i) {
                const std::uint32_t* record = slice.record(i, format_.words());
                if (slice.runs.empty()) keys_.push_back(sortKey(format_.place(record), slice.edgeLog2));
                for (std::size_t corner = 0; corner < 3; ++corner) {
                    indices_.push_back(welder.add(vertexOf(record, corner)));
                    if (format_.hasErrors()) addError(indices_.back(), format_.error(record, corner));
                }
            }
        }
        localOf_.assign(page_.vertices.size(), kUnseen);
    }

    void addError(std::uint32_t vertex, std::uint8_t error) {
        if (vertex == errors_.size()) errors_.push_back(0);
        errors_[vertex] = std::max(errors_[vertex], error);
    }

    // Ranges of the node that slices [first, last) belong to; those before are done.
    void addRanges(std::size_t first, std::size_t last, std::size_t triangles) {
        CHECK_OP(first, <, last);
        const std::size_t before = doneTriangles_;
        const std::uint32_t firstRange = static_cast<std::uint32_t>(page_.ranges.size());
        const Slice& slice = job_.slices[first];
        NodeRanges owner{slice.node, firstRange, 0, static_cast<std::uint32_t>(triangles), 0, {}, 0};
        for (const Run& run : slice.runs.empty() ? cutRuns(slice, triangles) : slice.runs) {
            addRange(doneTriangles_, before + run.end, run, owner.box);
            doneTriangles_ = before + run.end;
        }
        owner.rangeCount = static_cast<std::uint32_t>(page_.ranges.size()) - firstRange;
        countVertices(before, doneTriangles_, owner);
        nodes_.push_back(owner);
    }

    std::vector<Run> cutRuns(const Slice& slice, std::size_t triangles) {
        const std::span<const std::uint64_t> keys = std::span(keys_).last(keys_.size() - doneKeys_);
        doneKeys_ += triangles;
        std::vector<Run> runs;
        for (const CellRun& run :
             cutRanges(keys.first(triangles), slice.edgeLog2, slice.leastLevels, job_.around)) {
            runs.push_back({run.end, run.path, {}});
        }
        return runs;
    }

    // That the triangles [begin, end) use.
    void countVertices(std::size_t begin, std::size_t end, NodeRanges& owner) const {
        std::vector<bool> used(page_.vertices.size(), false);
        for (const std::uint32_t index : std::span(indices_).subspan(3 * begin, 3 * (end - begin))) {
            owner.vertices += used[index] ? 0 : 1;
            used[index] = true;
            if (!errors_.empty()) owner.error = std::max(owner.error, errors_[index]);
        }
    }

    void addRange(std::size_t begin, std::size_t end, const Run& run, LatticeBox& all) {
        Range range{};
        range.path = run.path;
        range.firstIndex = static_cast<std::uint32_t>(3 * begin);
        range.indexCount = static_cast<std::uint32_t>(3 * (end - begin));
        std::ranges::fill(range.boxMin, std::numeric_limits<std::uint32_t>::max());
        for (std::size_t axis = 0; axis < 3 && !run.box.empty(); ++axis) {
            range.boxMin[axis] = static_cast<std::uint32_t>(run.box.min[axis] - page_.origin[axis]);
            range.boxMax[axis] = static_cast<std::uint32_t>(run.box.max[axis] - page_.origin[axis]);
        }
        const std::span<std::uint32_t> indices =
            std::span(indices_).subspan(range.firstIndex, range.indexCount);
        for (const std::uint32_t index : indices) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::uint32_t value = page_.vertices[index].offset[axis];
                range.boxMin[axis] = std::min(range.boxMin[axis], value);
                range.boxMax[axis] = std::max(range.boxMax[axis], value);
            }
        }
        LatticeBox box;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.min[axis] = page_.origin[axis] + range.boxMin[axis];
            box.max[axis] = page_.origin[axis] + range.boxMax[axis];
        }
        all.add(box);
        optimiseCache(indices);
        page_.ranges.push_back(range);
    }

    // In numbers of its own, so that the cost goes with the range and not with the page.
    void optimiseCache(std::span<std::uint32_t> indices) {
        std::vector<std::uint32_t> vertices, local, best(indices.size());
        for (const std::uint32_t index : indices) {
            if (localOf_[index] == kUnseen) {
                localOf_[index] = static_cast<std::uint32_t>(vertices.size());
                vertices.push_back(index);
            }
            local.push_back(localOf_[index]);
        }
        meshopt_optimizeVertexCache(best.data(), local.data(), local.size(), vertices.size());
        std::ranges::transform(best, indices.begin(), [&](std::uint32_t index) { return vertices[index]; });
        for (const std::uint32_t vertex : vertices) localOf_[vertex] = kUnseen;
    }

    // Vertices in the order of their first use; indices to 16 bits.
    void reorderVertices() {
        std::vector<std::uint32_t> places(page_.vertices.size());
        meshopt_optimizeVertexFetchRemap(places.data(), indices_.data(), indices_.size(), places.size());
        const auto reorder = [&](auto& values) {
            auto old = values;
            for (std::size_t v = 0; v < old.size(); ++v) values[places[v]] = old[v];
        };
        reorder(page_.vertices);
        reorder(errors_);
        for (std::uint32_t& index : indices_) index = places[index];
        page_.indices.assign(indices_.size(), 0);
        std::ranges::transform(indices_, page_.indices.begin(),
                               [](std::uint32_t index) { return static_cast<std::uint16_t>(index); });
    }

    static constexpr std::uint32_t kUnseen = 0xffffffff;

    const PageJob& job_;
    const RecordFormat& format_;
    PageGeometry page_;
    CellPoint origin_{0};
    std::vector<std::uint32_t> indices_, localOf_;
    std::vector<std::uint64_t> keys_;  // of the triangles whose slices are to be cut
    std::vector<std::uint8_t> errors_;
    std::size_t triangles_ = 0, doneTriangles_ = 0, doneKeys_ = 0;
    std::vector<NodeRanges> nodes_;
};

}  // namespace

BuiltPage buildPage(const PageJob& job, const Lattice& lattice, const RecordFormat& format,
                    std::uint32_t attributes) {
    return Builder(job, lattice, format, attributes).run();
}

}  // namespace iwalk
