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
#include "preprocess/levels/ring.hpp"

namespace iwalk {
namespace {

// Sweeps go up these parts of the limit: cheap collapses come before dear ones nearly as if all were sorted.
constexpr std::array<float, 5> kSteps{0.25f, 0.5f, 0.67f, 0.83f, 1.0f};
// A step ends when a sweep collapses less than this part of the points that are left.
constexpr float kFewCollapses = 0.03f;
constexpr int kMostSweeps = 12;
// A triangle may turn by this cosine (about 75 degrees) at once.
constexpr float kLeastTurn = 0.26f;
// Of what a collapse costs, the part that counts for the errors of the points around it. Raised: safer, and
// more triangles. At 0 a rack of 7 million triangles came 1.14 times as far off as it may; at 0.25 0.98
// times, and with 0.5 a scan got 40 % more triangles.
constexpr float kCostAround = 0.25f;
constexpr int kJoinRounds = 2;

class Collapser {
  public:
    Collapser(CollapseMesh& mesh, const CollapseLimits& limits)
        : mesh_(mesh),
          limits_(limits),
          fans_(mesh.triangles, mesh.points.size()),
          faces_(mesh.triangles.size()),
          dirty_(mesh.points.size(), 1),
          sweep_(mesh.points.size(), 0),
          known_(mesh.points.size(), 0) {
        map_.points.resize(mesh.points.size());
        std::iota(map_.points.begin(), map_.points.end(), 0u);
        map_.wedges.resize(mesh.wedgeColors.size());
        std::iota(map_.wedges.begin(), map_.wedges.end(), 0u);
        for (std::uint32_t t = 0; t < faces_.size(); ++t) {
            faces_[t].corners = mesh.triangles[t];
            faces_[t].setNormal(mesh_.points);
        }
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
        ring_.findCosts(markFeatures(s));
        for (std::size_t place = 0; place < ring_.size(); ++place) {
            float cost = ring_.cost(place);
            for (std::size_t other = 0; other < ring_.size(); ++other) {
                const float edge = glm::length(ring_.way(other) - ring_.way(place));
                cost = std::max(cost, edge * (limits_.error / limits_.longestEdge));
            }
            least = std::min(least, cost);
        }
        return least;
    }

  private:
    bool alive(std::uint32_t point) const { return map_.points[point] == point; }
    const glm::vec3& at(std::uint32_t point) const { return mesh_.points[point]; }
    std::array<std::uint32_t, 3>& corners(std::uint32_t triangle) { return faces_[triangle].corners; }
    bool has(std::uint32_t triangle, std::uint32_t point) const { return faces_[triangle].has(point); }

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
            const std::size_t left = findCandidates(threshold);
            std::size_t collapsed = 0;
            for (std::size_t i = 0; i < candidates_.size(); ++i) {
                bringNear(i);
                const std::uint32_t point = candidates_[i];
                // Neighbours of what has collapsed wait for the next sweep: then collapses spread evenly.
                if (sweep_[point] != sweepNumber_) collapsed += collapsePoint(point, threshold) ? 1u : 0u;
            }
            if (static_cast<float>(collapsed) <= kFewCollapses * static_cast<float>(left)) return;
        }
    }

    // The points to look at, and how many are left. What was too dear is looked at again in the last step, if
    // its neighbourhood has changed: looking earlier took a quarter more looks for a thousandth fewer
    // triangles.
    std::size_t findCandidates(float threshold) {
        const bool last = threshold == limits_.error;
        std::size_t left = 0;
        candidates_.clear();
        for (std::uint32_t point = 0; point < map_.points.size(); ++point) {
            if (!alive(point) || mesh_.held[point] != 0) continue;
            ++left;
            const bool dear = known_[point] > threshold && !(last && dirty_[point] != 0);
            if (!dear && mesh_.errors[point] <= threshold) candidates_.push_back(point);
        }
        return left;
    }

    // What the next candidates look at is fetched from memory while this one is: up to an eighth of a build's
    // processor time, where memory is not what both threads wait for anyway.
    void bringNear(std::size_t i) const {
        const auto fanOf = [&](std::size_t ahead) {
            return i + ahead < candidates_.size() ? fans_.of(candidates_[i + ahead])
                                                  : std::span<const std::uint32_t>();
        };
        __builtin_prefetch(fanOf(6).data());
        for (const std::uint32_t triangle : fanOf(4)) __builtin_prefetch(&faces_[triangle]);
        for (const std::uint32_t triangle : fanOf(2)) {
            for (const std::uint32_t point : faces_[triangle].corners) {
                __builtin_prefetch(&mesh_.points[point]);
                __builtin_prefetch(&mesh_.errors[point]);
            }
        }
    }

    // Collapses s into its cheapest neighbour that will do.
    bool collapsePoint(std::uint32_t s, float threshold) {
        dirty_[s] = 0;
        known_[s] = limits_.error * 2;
        if (!findNeighbours(s)) return false;
        ring_.findCosts(markFeatures(s));
        findErrorAround();
        for (std::size_t place = 0; place < ring_.size(); ++place)
            ring_.cost(place) = errorAfter(s, place, ring_.cost(place));
        for (;;) {
            const std::size_t place = ring_.cheapest();
            const float least = ring_.cost(place);
            if (least > threshold) {
                known_[s] = std::min(known_[s], least);
                return false;
            }
            ring_.cost(place) = INFINITY;
            const float away = allowed(s, place, limits_.error - mesh_.errors[s]);
            if (away < 0) continue;
            const float error = std::max(least, errorAfter(s, place, away));
            if (error > threshold) {
                known_[s] = std::min(known_[s], error);
                continue;
            }
            contract(s, ring_.point(place), error);
            return true;
        }
    }

    // False when there is none, or too much for one.
    bool findNeighbours(std::uint32_t s) {
        ring_.clear();
        const auto fan = fans_.of(s);
        if (fan.empty() || fan.size() > Ring::kMostFan) return false;
        for (const std::uint32_t t : fan) {
            const auto& [a, b, c] = corners(t);
            const auto [after, before] = a == s   ? std::pair(b, c)
                                         : b == s ? std::pair(c, a)
                                                  : std::pair(a, b);
            const std::uint32_t first = placeInRing(s, after);
            ring_.addTriangle(t, faces_[t].normal, first, placeInRing(s, before));
        }
        return true;
    }

    std::uint32_t placeInRing(std::uint32_t s, std::uint32_t point) {
        const std::uint32_t place = ring_.find(point);
        return place != Ring::kNowhere ? place : ring_.add(point, at(point) - at(s));
    }

    // Whether there are any.
    bool markFeatures(std::uint32_t s) {
        bool any = false;
        for (std::size_t place = 0; place < ring_.size(); ++place) {
            Ring::Edge& edge = ring_.edge(place);
            edge.feature = ring_.endsAt(place) || (edge.count == 2 && colorsMeet(s, place));
            any = any || edge.feature;
        }
        return any;
    }

    bool colorsMeet(std::uint32_t s, std::size_t place) const {
        if (mesh_.wedges.empty()) return false;
        const Ring::Edge& edge = ring_.edge(place);
        const std::uint32_t point = ring_.point(place);
        const std::uint32_t first = ring_.fan(edge.first).triangle, second = ring_.fan(edge.second).triangle;
        return colorAt(first, s) != colorAt(second, s) || colorAt(first, point) != colorAt(second, point);
    }
    std::uint32_t colorAt(std::uint32_t t, std::uint32_t point) const {
        const auto& triangle = faces_[t].corners;
        const std::size_t corner = triangle[0] == point ? 0 : triangle[1] == point ? 1 : 2;
        return mesh_.wedgeColors[mesh_.wedges[t][corner]];
    }

    // The largest error of the ring's points, and of all the others.
    void findErrorAround() {
        mostAround_ = nextAround_ = 0;
        worst_ = 0;
        for (std::size_t place = 0; place < ring_.size(); ++place) {
            const float error = mesh_.errors[ring_.point(place)];
            if (error > mostAround_) {
                nextAround_ = std::exchange(mostAround_, error);
                worst_ = place;
            } else {
                nextAround_ = std::max(nextAround_, error);
            }
        }
    }

    // The error that the triangles of s have once it has gone to a neighbour at this cost. An edge may be
    // farther off in its middle than at its ends, by what one of them has taken in; so errors of the ring
    // count, too.
    float errorAfter(std::uint32_t s, std::size_t place, float cost) const {
        const float around = place == worst_ ? nextAround_ : mostAround_;
        return std::max(mesh_.errors[s] + cost, around + kCostAround * cost);
    }

    // The distance of s from its triangles once it has gone to its neighbour, and from its features; negative
    // when that is too far, or the mesh would not be what it should.
    float allowed(std::uint32_t s, std::size_t place, float most) const {
        const glm::vec3 self(0), to = ring_.way(place);
        float nearest = INFINITY;
        for (std::size_t i = 0; i < ring_.fanSize(); ++i) {
            const Ring::FanTriangle& triangle = ring_.fan(i);
            if (triangle.has(place)) continue;
            const glm::vec3 a = ring_.way(triangle.after), b = ring_.way(triangle.before);
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
        for (std::size_t other = 0; other < ring_.size(); ++other) {
            if (ring_.edge(other).feature && other != place) {
                nearest = std::max(nearest, segmentDistance(self, to, ring_.way(other)));
            }
        }
        return nearest > most || leavesLine(s, ring_.point(place)) ? -1 : nearest;
    }

    bool tooLong(const glm::vec3& to) const {
        const float most = limits_.longestEdge * limits_.longestEdge;
        for (std::size_t place = 0; place < ring_.size(); ++place) {
            const float length = squared(ring_.way(place) - to);
            if (length > most && length > squared(ring_.way(place))) return true;
        }
        return false;
    }

    // Triangles with both s and t become lines (t, w): each must be an edge of a triangle that stays.
    bool leavesLine(std::uint32_t s, std::uint32_t t) const {
        for (const std::uint32_t triangle : fans_.of(s)) {
            if (!has(triangle, t)) continue;
            const auto& [a, b, c] = faces_[triangle].corners;
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
        const auto isGone = [this](std::uint32_t triangle) { return faces_[triangle].isGone(); };
        fans_.tidy(s, isGone);
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
            for (const std::uint32_t point : std::exchange(corners(triangle), {s, s, s})) {
                if (point != s) fans_.remove(point, triangle, isGone);
            }
        }
        for (const std::uint32_t triangle : moved_) {
            std::ranges::replace(corners(triangle), s, t);
            faces_[triangle].setNormal(mesh_.points);
        }
        fans_.append(t, moved_);
        fans_.clear(s);
    }

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
    std::vector<Face> faces_;
    CollapseMap map_;
    std::vector<std::uint8_t> dirty_;   // by point: neighbourhood has changed since it was looked at
    std::vector<std::uint32_t> sweep_;  // by point: the sweep in which its neighbourhood last changed
    std::vector<float> known_;          // by point: at least what its collapse will cost
    std::uint32_t sweepNumber_ = 0;
    std::vector<std::uint32_t> candidates_;  // of the sweep, in order
    // Of the point under consideration:
    Ring ring_;
    std::size_t worst_ = 0;                  // the ring's place with the largest error
    float mostAround_ = 0, nextAround_ = 0;  // that one, and the largest of the others
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
