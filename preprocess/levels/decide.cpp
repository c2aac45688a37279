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

    Result<CellDecision> run(std::span<const std::uint32_t> touching, PageStore& store) {
        for (const std::uint32_t index : touching) {
            if (!stage_.pages[index].held) RETURN_IF_ERROR(gather(index, store));
        }
        CellDecision decision;
        if (mesh_.triangles.empty()) return decision;
        for (const std::uint32_t index : touching) {
            if (stage_.pages[index].held && nearFree(index, touching)) RETURN_IF_ERROR(hold(index, store));
        }
        const std::vector<float> before = mesh_.errors;
        const CollapseMap map = collapse(mesh_, stage_.limits);
        for (const Gathered& page : gathered_) {
            tell(page, map, before, decision.targets);
            ASSIGN_OR_RETURN(const bool moved, hasMoved(page, map, store));
            if (moved) decision.moved.push_back(page.index);
        }
        return decision;
    }

  private:
    struct Gathered {
        std::uint32_t index;
        std::shared_ptr<const SourcePage> page;
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
        const StagePage& source = stage_.pages[index];
        ASSIGN_OR_RETURN(std::shared_ptr<const SourcePage> page, store.get(source.number, source.record));
        Gathered gathered{index, page, std::vector<std::uint32_t>(page->positions.size(), kNoNumber), {}, {}};
        gathered.points.assign(page->positions.size(), kNoNumber);
        ASSIGN_OR_RETURN(gathered.errors, stage_.errors->of(source.number));
        std::vector<std::uint8_t> inside(page->positions.size());
        for (std::size_t v = 0; v < inside.size(); ++v)
            inside[v] = cell_.contains(page->positions[v]) ? 1 : 0;
        std::vector<std::uint32_t> around(page->positions.size());
        for (const Range& range : page->ranges) {
            if (outside(*page, range)) continue;
            for (std::uint32_t i = range.firstIndex; i < range.firstIndex + range.indexCount; i += 3) {
                const std::uint16_t* corner = &page->indices[i];
                const int in = inside[corner[0]] + inside[corner[1]] + inside[corner[2]];
                if (in == 1 && isTooMuch(around, corner, inside)) continue;
                if (in > 0) addTriangle(gathered, corner, in == 3);
            }
        }
        gathered_.push_back(std::move(gathered));
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

    void addTriangle(Gathered& from, const std::uint16_t* corner, bool whole) {
        std::array<std::uint32_t, 3> points{}, wedges{};
        for (std::size_t c = 0; c < 3; ++c) {
            if (from.points[corner[c]] == kNoNumber) addVertex(from, corner[c]);
            points[c] = from.points[corner[c]];
            wedges[c] = from.wedges[corner[c]];
            if (!whole) mesh_.held[points[c]] = 1;
        }
        mesh_.triangles.push_back(points);
        if (hasAttributes(*from.page)) mesh_.wedges.push_back(wedges);
    }

    void addVertex(Gathered& from, std::uint16_t vertex) {
        const SourcePage& page = *from.page;
        const auto [point, isNew] = points_.add(page.positions[vertex]);
        const float error = from.errors.empty()
                                ? stage_.pages[from.index].error
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
        const SourcePage& page = *from.page;
        for (std::uint32_t v = 0; v < from.points.size(); ++v) {
            const std::uint32_t point = from.points[v];
            if (point == kNoNumber || !cell_.contains(page.positions[v])) continue;
            const std::uint32_t image = map.points[point];
            VertexTarget target{from.index, v, mesh_.errors[image], 0, 0, points_[image]};
            bool changed = image != point || mesh_.errors[image] != before[point];
            if (hasAttributes(page)) {
                const Wedge& wedge = wedges_[map.wedges[from.wedges[v]]];
                target.color = wedge.color;
                target.normal = wedge.normal;
                changed = changed || map.wedges[from.wedges[v]] != from.wedges[v];
            }
            if (changed) targets.push_back(target);
        }
    }

    // Whether vertices in the cell of a page that is not fresh go elsewhere than its morph block says.
    Result<bool> hasMoved(const Gathered& from, const CollapseMap& map, PageStore& store) const {
        const StagePage& source = stage_.pages[from.index];
        if (source.fresh) return false;
        const bool isInside = std::ranges::any_of(
            from.page->positions, [&](const CellPoint& position) { return cell_.contains(position); });
        if (!isInside || source.record.morphBytes == 0) return isInside;
        ASSIGN_OR_RETURN(const std::vector<CellPoint> before, store.targets(source.record, *from.page));
        for (std::size_t v = 0; v < before.size(); ++v) {
            const std::uint32_t point = from.points[v];
            if (point == kNoNumber || !cell_.contains(from.page->positions[v])) continue;
            if (points_[map.points[point]] != before[v]) return true;
        }
        return false;
    }

    const SpaceCell& cell_;
    const Stage& stage_;
    CellPoint centre_{0};
    CollapseMesh mesh_;
    Numbers<CellPoint, PointHash> points_;
    Numbers<Wedge, WedgeHash> wedges_;
    std::vector<Gathered> gathered_;
};

}  // namespace

Result<CellDecision> decideCell(const SpaceCell& cell, const Stage& stage,
                                std::span<const std::uint32_t> touching, PageStore& store) {
    return CellJob(cell, stage).run(touching, store);
}

}  // namespace iwalk
