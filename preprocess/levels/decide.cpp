#include "preprocess/levels/decide.hpp"

#include <algorithm>

#include "preprocess/levels/numbers.hpp"

namespace iwalk {
namespace {

// Of the triangles of a page that have only one corner in the cell, the same one, so many count. These stay,
// as their other corners do, and are enough to keep that vertex where it is (Ring::kMostFan); all of them
// might be the whole model.
constexpr std::uint32_t kMostAround = 512;

struct Wedge {
    std::uint32_t point, color, normal;
    bool operator==(const Wedge&) const = default;
};
struct WedgeHash {
    std::size_t operator()(const Wedge& w) const {
        return static_cast<std::size_t>(mixBits(w.point ^ mixBits(w.color | std::uint64_t{w.normal} << 32)));
    }
};

class CellJob {
  public:
    CellJob(const SpaceCell& cell, const Stage& stage) : cell_(cell), stage_(stage) {
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            centre_[axis] = cell.low[axis] + (cell.high[axis] - cell.low[axis]) / 2;
        }
    }

    // Adds what becomes of the vertices in the cell; false when it has too many triangles.
    Result<bool> run(std::span<const std::uint32_t> touching, PageStore& store, std::size_t mostTriangles,
                     CellDecision& decision) {
        for (const std::uint32_t index : touching) {
            if (!stage_.pages[index].held) RETURN_IF_ERROR(gather(index, store));
            if (std::max(mesh_.triangles.size(), mesh_.points.size()) > mostTriangles) return false;
        }
        if (mesh_.triangles.empty()) return true;
        for (const std::uint32_t index : touching) {
            if (stage_.pages[index].held && nearFree(index, touching)) RETURN_IF_ERROR(hold(index, store));
        }
        const std::vector<float> before = mesh_.errors;
        const CollapseMap map = collapse(mesh_, stage_.limits);
        for (const Gathered& page : gathered_) tell(page, map, before, decision.targets);
        const auto imageOf = [&](const CellPoint& position) {
            const std::uint32_t point = points_.find(position);
            return point == kNoNumber ? position : points_[map.points[point]];
        };
        RETURN_IF_ERROR(findMoved(touching, store, imageOf, decision));
        return true;
    }

    // Whether halves would have vertices that may move, and not only triangles that reach out of them.
    bool isMostlyWhole() const { return 2 * whole_ > mesh_.triangles.size(); }

    // All of them stay.
    Result<void> stay(std::span<const std::uint32_t> touching, PageStore& store, CellDecision& decision) {
        return findMoved(
            touching, store, [](const CellPoint& p) { return p; }, decision);
    }

  private:
    // A page's vertices in the cell.
    struct Gathered {
        struct Vertex {
            std::uint32_t vertex, point, wedge;
        };
        std::uint32_t index;
        std::vector<Vertex> vertices;
    };
    // A page that is being gathered.
    struct Page {
        const StagePage& stage;
        const SourcePage& source;
        std::vector<std::uint32_t> wedges,
            points;                        // by vertex; kNoNumber when no triangle in the cell uses it
        std::vector<std::uint8_t> errors;  // by vertex, as in Stage::errors
    };

    bool hasAttributes(const SourcePage& page) const { return !page.colors.empty() || !page.normals.empty(); }

    bool outside(const SourcePage& page, const Range& range) const {
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            if (page.origin[axis] + range.boxMin[axis] >= cell_.high[axis]) return true;
            if (page.origin[axis] + range.boxMax[axis] < cell_.low[axis]) return true;
        }
        return false;
    }

    Result<void> gather(std::uint32_t index, PageStore& store) {
        const StagePage& stagePage = stage_.pages[index];
        ASSIGN_OR_RETURN(const std::shared_ptr<const SourcePage> source,
                         store.get(stagePage.number, stagePage.record));
        const std::size_t vertices = source->positions.size();
        const std::vector<std::uint32_t> none(vertices, kNoNumber);
        Page page{stagePage, *source, none, none, {}};
        ASSIGN_OR_RETURN(page.errors, stage_.errors->of(stagePage.number));
        std::vector<std::uint8_t> inside(vertices);
        for (std::size_t v = 0; v < vertices; ++v) inside[v] = cell_.contains(source->positions[v]) ? 1 : 0;
        std::vector<std::uint32_t> around(vertices);
        for (const Range& range : source->ranges) {
            if (outside(*source, range)) continue;
            for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; i += 3) {
                const std::uint16_t* corner = &source->indices[i];
                const int in = inside[corner[0]] + inside[corner[1]] + inside[corner[2]];
                if (in == 1 && isTooMuch(around, corner, inside)) continue;
                if (in > 0) addTriangle(page, corner, in == 3);
            }
        }
        Gathered gathered{index, {}};
        for (std::uint32_t v = 0; v < vertices; ++v) {
            if (inside[v] != 0 && page.points[v] != kNoNumber)
                gathered.vertices.push_back({v, page.points[v], page.wedges[v]});
        }
        if (!gathered.vertices.empty()) gathered_.push_back(std::move(gathered));
        return {};
    }

    // Counts a triangle with a single corner in the cell.
    static bool isTooMuch(std::vector<std::uint32_t>& around, const std::uint16_t* corner,
                          const std::vector<std::uint8_t>& inside) {
        const std::uint16_t vertex = inside[corner[0]]   ? corner[0]
                                     : inside[corner[1]] ? corner[1]
                                                         : corner[2];
        return ++around[vertex] > kMostAround;
    }

    void addTriangle(Page& from, const std::uint16_t* corner, bool whole) {
        std::array<std::uint32_t, 3> points{}, wedges{};
        for (std::size_t c = 0; c < 3; ++c) {
            if (from.points[corner[c]] == kNoNumber) addVertex(from, corner[c]);
            points[c] = from.points[corner[c]];
            wedges[c] = from.wedges[corner[c]];
            if (!whole) mesh_.held[points[c]] = 1;
        }
        mesh_.triangles.push_back(points);
        whole_ += whole ? 1 : 0;
        if (hasAttributes(from.source)) mesh_.wedges.push_back(wedges);
    }

    void addVertex(Page& from, std::uint16_t vertex) {
        const SourcePage& page = from.source;
        const auto [point, isNew] = points_.add(page.positions[vertex]);
        const float error = from.errors.empty()
                                ? from.stage.error
                                : static_cast<float>(from.errors[vertex]) * (stage_.errorUnit / 255.0f);
        if (isNew) {
            const CellPoint& p = page.positions[vertex];
            mesh_.points.emplace_back(relative(p.x, centre_.x), relative(p.y, centre_.y),
                                      relative(p.z, centre_.z));
            mesh_.errors.push_back(error);
            mesh_.held.push_back(0);
        }
        mesh_.errors[point] = std::max(mesh_.errors[point], error);
        from.points[vertex] = point;
        if (!hasAttributes(page)) return;
        const std::uint32_t color = page.colors.empty() ? 0 : page.colors[vertex];
        const std::uint32_t normal = page.normals.empty() ? 0 : page.normals[vertex];
        const auto [wedge, isNewWedge] = wedges_.add({point, color, normal});
        if (isNewWedge) mesh_.wedgeColors.push_back(color);
        from.wedges[vertex] = wedge;
    }

    static float relative(std::uint64_t value, std::uint64_t centre) {
        return static_cast<float>(static_cast<std::int64_t>(value - centre));
    }

    // Whether a page that may change reaches into the box of the one held.
    bool nearFree(std::uint32_t held, std::span<const std::uint32_t> touching) const {
        const StagePage& a = stage_.pages[held];
        return std::ranges::any_of(touching, [&](std::uint32_t index) {
            const StagePage& b = stage_.pages[index];
            if (b.held) return false;
            for (glm::length_t axis = 0; axis < 3; ++axis) {
                if (a.low[axis] > b.high[axis] || b.low[axis] > a.high[axis]) return false;
            }
            return true;
        });
    }

    Result<void> hold(std::uint32_t index, PageStore& store) {
        const StagePage& source = stage_.pages[index];
        ASSIGN_OR_RETURN(const std::shared_ptr<const SourcePage> page,
                         store.get(source.number, source.record));
        for (const CellPoint& position : page->positions) {
            if (!cell_.contains(position)) continue;
            const std::uint32_t point = points_.find(position);
            if (point != kNoNumber) mesh_.held[point] = 1;
        }
        return {};
    }

    // What has become of a page's vertices in the cell.
    void tell(const Gathered& from, const CollapseMap& map, const std::vector<float>& before,
              std::vector<VertexTarget>& targets) const {
        for (const auto& [vertex, point, wedge] : from.vertices) {
            const std::uint32_t image = map.points[point];
            VertexTarget target{from.index, vertex, mesh_.errors[image], 0, 0, points_[image]};
            bool changed = image != point || mesh_.errors[image] != before[point];
            if (wedge != kNoNumber) {
                const std::uint32_t imageWedge = map.wedges[wedge];
                target.color = wedges_[imageWedge].color;
                target.normal = wedges_[imageWedge].normal;
                changed = changed || imageWedge != wedge;
            }
            if (changed) targets.push_back(target);
        }
    }

    // The pages, not fresh, with vertices in the cell that go elsewhere than their morph blocks say.
    template <class ImageOf>
    Result<void> findMoved(std::span<const std::uint32_t> touching, PageStore& store, const ImageOf& imageOf,
                           CellDecision& decision) const {
        for (const std::uint32_t index : touching) {
            const StagePage& page = stage_.pages[index];
            if (page.held || page.fresh) continue;
            ASSIGN_OR_RETURN(const std::shared_ptr<const SourcePage> source,
                             store.get(page.number, page.record));
            const auto inside = [&](const CellPoint& p) { return cell_.contains(p); };
            const std::vector<CellPoint>& positions = source->positions;
            if (std::ranges::none_of(positions, inside)) continue;
            std::vector<CellPoint> before;
            if (page.record.morphBytes > 0) {
                ASSIGN_OR_RETURN(before, store.targets(page.record, *source));
            }
            bool moved = before.empty();
            for (std::size_t v = 0; v < before.size() && !moved; ++v)
                moved = inside(positions[v]) && imageOf(positions[v]) != before[v];
            if (moved) decision.moved.push_back(index);
        }
        return {};
    }

    const SpaceCell& cell_;
    const Stage& stage_;
    CellPoint centre_{0};
    CollapseMesh mesh_;
    std::size_t whole_ = 0;  // triangles with all corners in the cell
    Numbers<CellPoint, PointHash> points_;
    Numbers<Wedge, WedgeHash> wedges_;
    std::vector<Gathered> gathered_;
};

// Adds to `decision`. Models differ in how many triangles are in a cell: some are as dense as no
// simplification leaves them, and long triangles lie in nodes that are far larger than their ends.
Result<void> decide(const SpaceCell& cell, const Stage& stage, std::span<const std::uint32_t> touching,
                    PageStore& store, std::size_t mostTriangles, CellDecision& decision) {
    const CellPoint edges = cell.high - cell.low;
    const glm::length_t axis = edges.x >= edges.y && edges.x >= edges.z ? 0 : edges.y >= edges.z ? 1 : 2;
    {
        CellJob job(cell, stage);
        ASSIGN_OR_RETURN(const bool done, job.run(touching, store, mostTriangles, decision));
        if (done) return {};
        const bool isPoint = static_cast<float>(edges[axis]) <= stage.limits.error;
        if (isPoint || !job.isMostlyWhole()) return job.stay(touching, store, decision);
    }  // its memory is free for the halves
    SpaceCell low = cell, high = cell;
    low.high[axis] = high.low[axis] = cell.low[axis] + edges[axis] / 2;
    for (const SpaceCell& half : {low, high}) {
        std::vector<std::uint32_t> pages;
        std::ranges::copy_if(touching, std::back_inserter(pages), [&](std::uint32_t index) {
            return half.meets(stage.pages[index].low, stage.pages[index].high);
        });
        RETURN_IF_ERROR(decide(half, stage, pages, store, mostTriangles, decision));
    }
    return {};
}

}  // namespace

Result<CellDecision> decideCell(const SpaceCell& cell, const Stage& stage,
                                std::span<const std::uint32_t> touching, PageStore& store,
                                std::size_t mostTriangles) {
    CellDecision decision;
    RETURN_IF_ERROR(decide(cell, stage, touching, store, mostTriangles, decision));
    return decision;
}

}  // namespace iwalk
