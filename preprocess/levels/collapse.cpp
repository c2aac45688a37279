// Half-edge collapse bounded by distances rather than quadrics, which are none, then joining of near points
// (Garland and Heckbert 1997, section 3.2, without their metric). Errors are carried by points from level to
// level.
#include "preprocess/levels/collapse.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "common/check.hpp"
#include "preprocess/levels/distances.hpp"
#include "preprocess/levels/fans.hpp"
#include "preprocess/levels/near_points.hpp"

namespace iwalk {
namespace {

// Sweeps go up these parts of the limit: cheap collapses come before dear ones nearly as if all were sorted.
constexpr std::array<float, 5> kSteps{0.25f, 0.5f, 0.67f, 0.83f, 1.0f};
// A step ends when a sweep collapses less than this part of the points that are left.
constexpr float kFewCollapses = 0.01f;
constexpr int kMostSweeps = 12;
// A triangle may turn by this cosine (about 75 degrees) at once.
constexpr float kLeastTurn = 0.26f;
// Points with more triangles than this are only collapsed into.
constexpr std::size_t kMostFan = 48;
constexpr int kJoinRounds = 2;

class Collapser {
  public:
    Collapser(CollapseMesh& mesh, const CollapseLimits& limits)
        : mesh_(mesh),
          limits_(limits),
          fans_(mesh.triangles, mesh.points.size()),
          normals_(mesh.triangles.size()),
          dirty_(mesh.points.size(), 1),
          sweep_(mesh.points.size(), 0),
          known_(mesh.points.size(), 0) {
        map_.points.resize(mesh.points.size());
        std::iota(map_.points.begin(), map_.points.end(), 0u);
        map_.wedges.resize(mesh.wedgeColors.size());
        std::iota(map_.wedges.begin(), map_.wedges.end(), 0u);
        for (std::uint32_t t = 0; t < normals_.size(); ++t) updateNormal(t);
    }

    CollapseMap run() {
        for (const float step : kSteps) collapseUpTo(step * limits_.error);
        for (int round = 0; round < kJoinRounds && joinNear() > 0; ++round) collapseUpTo(limits_.error);
        flatten(map_.points);
        flatten(map_.wedges);
        return std::move(map_);
    }

    float cheapest(std::uint32_t s) {
        float least = INFINITY;
        if (!findNeighbours(s)) return least;
        markFeatures(s);
        for (std::size_t place = 0; place < ring_.size(); ++place) {
            float cost = costOf(place, least);
            for (const Neighbour& other : ring_) {
                const float edge = glm::length(other.way - ring_[place].way);
                cost = std::max(cost, edge * (limits_.error / limits_.longestEdge));
            }
            least = std::min(least, cost);
        }
        return least;
    }

  private:
    // A neighbour of the point under consideration.
    struct Neighbour {
        std::uint32_t point;
        std::uint32_t first;   // a triangle of the edge
        std::uint32_t second;  // the other one, when count is 2
        int count;             // triangles at the edge
        bool feature;          // border, sharp fold, or two colours meet
        glm::vec3 way;         // to it
        float cost;
    };
    // A triangle of the point: the point, then `after` and `before` of the ring, in the triangle's order.
    struct FanTriangle {
        glm::vec3 normal;
        std::uint32_t after, before;  // places in the ring
        bool has(std::size_t place) const { return after == place || before == place; }
    };

    bool alive(std::uint32_t point) const { return map_.points[point] == point; }
    const glm::vec3& at(std::uint32_t point) const { return mesh_.points[point]; }
    std::array<std::uint32_t, 3>& corners(std::uint32_t triangle) { return mesh_.triangles[triangle]; }
    bool has(std::uint32_t triangle, std::uint32_t point) const {
        const auto& [a, b, c] = mesh_.triangles[triangle];
        return a == point || b == point || c == point;
    }

    void updateNormal(std::uint32_t t) {
        const auto& [a, b, c] = corners(t);
        const glm::vec3 cross = glm::cross(at(b) - at(a), at(c) - at(a));
        const float length = glm::length(cross);
        normals_[t] = length > 0 ? cross / length : glm::vec3(0);
    }

    // The images of images.
    static void flatten(std::vector<std::uint32_t>& map) {
        for (std::uint32_t i = 0; i < map.size(); ++i) {
            std::uint32_t end = i;
            while (map[end] != end) end = map[end];
            for (std::uint32_t j = i; map[j] != end;) j = std::exchange(map[j], end);
        }
    }

    void collapseUpTo(float threshold) {
        for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
            ++sweepNumber_;
            std::size_t left = 0, collapsed = 0;
            for (std::uint32_t point = 0; point < map_.points.size(); ++point) {
                if (!alive(point) || mesh_.held[point] != 0) continue;
                ++left;
                collapsed += collapsePoint(point, threshold) ? 1u : 0u;
            }
            if (static_cast<float>(collapsed) <= kFewCollapses * static_cast<float>(left)) return;
        }
    }

    // Collapses s into its cheapest neighbour that will do.
    bool collapsePoint(std::uint32_t s, float threshold) {
        // `known_` bounds what it would cost; where nothing changed it is not computed again.
        if (sweep_[s] == sweepNumber_ || (dirty_[s] == 0 && known_[s] > threshold)) return false;
        if (mesh_.errors[s] > threshold) return false;
        dirty_[s] = 0;
        known_[s] = limits_.error * 2;
        const float room = limits_.error - mesh_.errors[s];
        if (!findNeighbours(s)) return false;
        markFeatures(s);
        for (std::size_t i = 0; i < ring_.size(); ++i) ring_[i].cost = costOf(i, room);
        for (;;) {
            const auto best = std::ranges::min_element(ring_, {}, &Neighbour::cost);
            if (best == ring_.end() || best->cost > room) return false;
            const std::size_t place = static_cast<std::size_t>(best - ring_.begin());
            const float total = mesh_.errors[s] + best->cost;
            if (total > threshold) {
                known_[s] = std::min(known_[s], total);
                return false;
            }
            const float away = allowed(s, place, room);
            const float error = mesh_.errors[s] + std::max(best->cost, away);
            best->cost = INFINITY;
            if (away < 0) continue;
            if (error > threshold) {
                known_[s] = std::min(known_[s], error);
                continue;
            }
            contract(s, best->point, error);
            return true;
        }
    }

    bool findNeighbours(std::uint32_t s) {
        ring_.clear();
        fan_.clear();
        const auto fan = fans_.of(s);
        if (fan.size() > kMostFan) return false;
        for (const std::uint32_t t : fan) {
            const auto& [a, b, c] = corners(t);
            const auto [after, before] = a == s   ? std::pair(b, c)
                                         : b == s ? std::pair(c, a)
                                                  : std::pair(a, b);
            const std::uint32_t first = placeInRing(s, after, t);
            fan_.push_back({normals_[t], first, placeInRing(s, before, t)});
        }
        return true;
    }

    std::uint32_t placeInRing(std::uint32_t s, std::uint32_t point, std::uint32_t t) {
        for (std::uint32_t place = 0; place < ring_.size(); ++place) {
            if (ring_[place].point != point) continue;
            if (++ring_[place].count == 2) ring_[place].second = t;
            return place;
        }
        ring_.push_back({point, t, t, 1, false, at(point) - at(s), 0});
        return static_cast<std::uint32_t>(ring_.size() - 1);
    }

    void markFeatures(std::uint32_t s) {
        features_ = false;
        for (Neighbour& edge : ring_) {
            const bool folded = edge.count == 2 && glm::dot(normals_[edge.first], normals_[edge.second]) < 0;
            edge.feature = edge.count == 1 || folded || (edge.count == 2 && colorsMeet(s, edge));
            features_ = features_ || edge.feature;
        }
    }

    bool colorsMeet(std::uint32_t s, const Neighbour& edge) const {
        if (mesh_.wedges.empty()) return false;
        return colorAt(edge.first, s) != colorAt(edge.second, s) ||
               colorAt(edge.first, edge.point) != colorAt(edge.second, edge.point);
    }
    std::uint32_t colorAt(std::uint32_t t, std::uint32_t point) const {
        const auto& triangle = mesh_.triangles[t];
        const std::size_t corner = triangle[0] == point ? 0 : triangle[1] == point ? 1 : 2;
        return mesh_.wedgeColors[mesh_.wedges[t][corner]];
    }

    // The largest distance of a neighbour from the planes of the point's triangles and the lines of its
    // features; INFINITY when that is more than `most`.
    float costOf(std::size_t place, float most) const {
        const glm::vec3& way = ring_[place].way;
        float cost = 0;
        for (const FanTriangle& triangle : fan_) {
            if (!triangle.has(place)) cost = std::max(cost, std::abs(glm::dot(triangle.normal, way)));
        }
        if (cost > most) return INFINITY;
        if (!features_) return cost;
        for (const Neighbour& edge : ring_) {
            if (!edge.feature || &edge == &ring_[place]) continue;
            const float length = squared(edge.way);
            if (length > 0) {
                cost = std::max(cost, glm::length(way - (glm::dot(way, edge.way) / length) * edge.way));
            }
        }
        return cost > most ? INFINITY : cost;
    }

    // The distance of s from its triangles once it has gone to its neighbour, and from its features; negative
    // when that is too far, or the mesh would not be what it should.
    float allowed(std::uint32_t s, std::size_t place, float most) const {
        const glm::vec3 self(0), to = ring_[place].way;
        float nearest = INFINITY;
        for (const FanTriangle& triangle : fan_) {
            if (triangle.has(place)) continue;
            const glm::vec3 &a = ring_[triangle.after].way, &b = ring_[triangle.before].way;
            const glm::vec3 cross = glm::cross(a - to, b - to);
            const float length = glm::length(cross);
            const bool hadNormal = triangle.normal != glm::vec3(0);
            if (hadNormal && !(glm::dot(cross, triangle.normal) > kLeastTurn * length)) return -1;
            if (length > 0) {
                nearest = std::min(nearest, triangleDistance(self, to, a, b, cross / length));
            } else {
                nearest = std::min({nearest, segmentDistance(self, to, a), segmentDistance(self, a, b)});
            }
        }
        if (nearest == INFINITY) nearest = glm::length(to);
        if (nearest > most || tooLong(to)) return -1;
        for (const Neighbour& edge : ring_) {
            if (edge.feature && &edge != &ring_[place]) {
                nearest = std::max(nearest, segmentDistance(self, to, edge.way));
            }
        }
        return nearest > most || leavesLine(s, ring_[place].point) ? -1 : nearest;
    }

    bool tooLong(const glm::vec3& to) const {
        const float most = limits_.longestEdge * limits_.longestEdge;
        return std::ranges::any_of(ring_, [&](const Neighbour& edge) {
            const float length = squared(edge.way - to);
            return length > most && length > squared(edge.way);
        });
    }

    // Triangles with both s and t become lines (t, w): each must be an edge of a triangle that stays.
    bool leavesLine(std::uint32_t s, std::uint32_t t) const {
        for (const std::uint32_t triangle : fans_.of(s)) {
            if (!has(triangle, t)) continue;
            const auto& [a, b, c] = mesh_.triangles[triangle];
            const std::uint32_t w = a ^ b ^ c ^ s ^ t;
            const auto holds = [&](std::uint32_t other, std::uint32_t without) {
                return has(other, w) && !has(other, without);
            };
            const bool kept = std::ranges::any_of(fans_.of(s), [&](auto other) { return holds(other, t); }) ||
                              std::ranges::any_of(fans_.of(t), [&](auto other) { return holds(other, s); });
            if (!kept) return true;
        }
        return false;
    }

    void contract(std::uint32_t s, std::uint32_t t, float error) {
        mapWedges(s, t);
        map_.points[s] = t;
        mesh_.errors[t] = std::max(mesh_.errors[t], error);
        moved_.clear();
        for (const std::uint32_t triangle : fans_.of(s)) {
            touch(triangle);
            if (!has(triangle, t)) moved_.push_back(triangle);
        }
        // What has become a line goes.
        for (const std::uint32_t triangle : fans_.of(s)) {
            if (!has(triangle, t)) continue;
            for (const std::uint32_t point : corners(triangle)) {
                if (point != s) fans_.remove(point, triangle);
            }
        }
        for (const std::uint32_t triangle : moved_) {
            std::ranges::replace(corners(triangle), s, t);
            updateNormal(triangle);
        }
        fans_.append(t, moved_);
        fans_.clear(s);
    }

    // Neighbours wait for the next sweep: then collapses spread evenly.
    void touch(std::uint32_t triangle) {
        for (const std::uint32_t point : corners(triangle)) {
            dirty_[point] = 1;
            sweep_[point] = sweepNumber_;
        }
    }

    // Wedges of s become those of t that they share a vanishing triangle with; others keep their attributes.
    void mapWedges(std::uint32_t s, std::uint32_t t) {
        if (mesh_.wedges.empty()) return;
        for (const std::uint32_t triangle : fans_.of(s)) {
            if (!has(triangle, t)) continue;
            const auto& points = corners(triangle);
            std::uint32_t from = 0, to = 0;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                if (points[corner] == s) from = mesh_.wedges[triangle][corner];
                if (points[corner] == t) to = mesh_.wedges[triangle][corner];
            }
            if (map_.wedges[from] == from && from != to) map_.wedges[from] = to;
        }
        for (const std::uint32_t triangle : fans_.of(s)) {
            for (std::uint32_t& wedge : mesh_.wedges[triangle]) wedge = map_.wedges[wedge];
        }
    }

    // Joins points that are as near as their errors leave. A point of the surface moves no farther than its
    // corners do, so this is within the limit whatever the triangles look like.
    std::size_t joinNear() {
        ++sweepNumber_;
        std::vector<std::uint32_t> left;
        for (std::uint32_t point = 0; point < map_.points.size(); ++point) {
            if (alive(point) && !fans_.of(point).empty()) left.push_back(point);
        }
        NearPoints near(mesh_.points, left, limits_.error);
        std::size_t joined = 0;
        for (const std::uint32_t s : left) {
            const float reach = limits_.error - mesh_.errors[s];
            if (mesh_.held[s] != 0 || reach <= 0 || fans_.of(s).empty()) continue;
            near.find(s, reach, found_);
            for (const auto& [distance, t] : found_) {
                if (!alive(t) || fans_.of(t).empty() || leavesLine(s, t)) continue;
                contract(s, t, mesh_.errors[s] + distance);
                ++joined;
                break;
            }
        }
        return joined;
    }

    CollapseMesh& mesh_;
    const CollapseLimits limits_;
    Fans fans_;
    std::vector<glm::vec3> normals_;  // unit; 0 of triangles without area
    CollapseMap map_;
    std::vector<std::uint8_t> dirty_;   // by point: neighbourhood has changed since it was looked at
    std::vector<std::uint32_t> sweep_;  // by point: the sweep in which its neighbourhood last changed
    std::vector<float> known_;          // by point: at least what its collapse will cost
    std::uint32_t sweepNumber_ = 0;
    // Of the point under consideration:
    std::vector<Neighbour> ring_;
    std::vector<FanTriangle> fan_;
    bool features_ = false;  // the ring has some
    std::vector<std::uint32_t> moved_;
    std::vector<NearPoints::Found> found_;
};

}  // namespace

std::vector<float> collapseErrors(CollapseMesh& mesh, std::span<const std::uint32_t> points,
                                  float edgesPerError) {
    Collapser collapser(mesh, {1, edgesPerError});
    std::vector<float> errors;
    for (const std::uint32_t point : points) errors.push_back(collapser.cheapest(point));
    return errors;
}

CollapseMap collapse(CollapseMesh& mesh, const CollapseLimits& limits) {
    CHECK_OP(mesh.points.size(), ==, mesh.errors.size());
    CHECK_OP(mesh.points.size(), ==, mesh.held.size());
    return Collapser(mesh, limits).run();
}

}  // namespace iwalk
