#include "tests/tools/levels/cracks.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "tests/tools/levels/close_input.hpp"
#include "tests/tools/levels/open_edges.hpp"

namespace iwalk::levels {
namespace {

// A distance within which everything is: levels that begin here are refined, and nothing morphs to them.
constexpr double kFar = 1e300;

double distanceToBox(const glm::dvec3& eye, const LatticeBox& box) {
    return glm::distance(eye, glm::clamp(eye, glm::dvec3(box.min), glm::dvec3(box.max)));
}

double uniform(std::mt19937_64& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

std::size_t looseBoxes(const RangeModel& model) {
    return static_cast<std::size_t>(std::ranges::count_if(model.ranges(), [&](const CutRange& range) {
        return range.parent != kNoRange && !model.ranges()[range.parent].box.contains(range.box);
    }));
}

// From which on ranges morph to their next coarser level.
double morphDistance(const CutRange& range, const std::vector<double>& distances) {
    return range.next < 0 ? kFar : distances[static_cast<std::size_t>(range.next)];
}

}  // namespace

double logUniform(std::mt19937_64& random, double low, double high) {
    return std::exp(uniform(random, std::log(low), std::log(high)));
}

glm::dvec3 randomEye(std::mt19937_64& random, const LatticeBox& box) {
    const glm::dvec3 min(box.min), max(box.max);
    if (uniform(random, 0, 1) < 0.5)
        return {uniform(random, min.x, max.x), uniform(random, min.y, max.y), uniform(random, min.z, max.z)};
    std::normal_distribution<double> normal;
    const glm::dvec3 way(normal(random), normal(random), normal(random));
    return 0.5 * (min + max) + glm::distance(min, max) * logUniform(random, 0.3, 4) * glm::normalize(way);
}

std::vector<double> levelDistances(const std::vector<double>& errors, const std::vector<double>& diagonals,
                                   double scale, double screenError) {
    std::vector<double> distances(errors.size());
    double finer = 0;
    for (std::size_t level = errors.size(); level-- > 0;) {
        const double seen = scale * errors[level] / (screenError * (1 - kBlendShare));
        finer = std::max({seen, diagonals[level] / kDiagonalShare, 2 * finer});
        distances[level] = finer;
    }
    return distances;
}

bool CutDrawer::isDrawn(const CutRange& range, const glm::dvec3& eye,
                        const std::vector<double>& distances) const {
    const auto at = [&](int level) { return distances[static_cast<std::size_t>(level)]; };
    if (range.level != model_.fullLevel() && distanceToBox(eye, range.box) < at(range.level)) return false;
    return range.parent == kNoRange || distanceToBox(eye, model_.ranges()[range.parent].box) < at(range.next);
}

glm::dvec3 CutDrawer::drawnAt(const MorphVertex& vertex, const glm::dvec3& eye, double distance) const {
    const glm::dvec3& p = model_.places()[vertex.place];
    const glm::dvec3& q = model_.places()[vertex.target];
    const double start = (1 - kBlendShare) * distance;
    const double w = std::clamp((glm::distance(eye, p) - start) / (kBlendShare * distance), 0.0, 1.0);
    return p + w * (q - p);
}

// The number of the place where a vertex is drawn; places on the way have numbers beyond the others.
std::uint32_t CutDrawer::cornerAt(const MorphVertex& vertex, const glm::dvec3& eye, double distance) const {
    if (vertex.place == vertex.target) return vertex.place;
    const glm::dvec3 drawn = drawnAt(vertex, eye, distance);
    if (drawn == model_.places()[vertex.place]) return vertex.place;
    if (drawn == model_.places()[vertex.target]) return vertex.target;
    return static_cast<std::uint32_t>(model_.places().size()) + vertex.between;
}

std::vector<tools::Triangle> CutDrawer::triangles(const glm::dvec3& eye,
                                                  const std::vector<double>& distances) const {
    std::vector<tools::Triangle> result;
    for (const CutRange& range : model_.ranges()) {
        if (!isDrawn(range, eye, distances)) continue;
        const double distance = morphDistance(range, distances);
        for (std::size_t i = 0; i < range.corners.size(); i += 3) {
            tools::Triangle& triangle = result.emplace_back();
            for (std::size_t c = 0; c < 3; ++c) triangle[c] = drawnAt(range.corners[i + c], eye, distance);
        }
    }
    return result;
}

Cut CutDrawer::draw(const glm::dvec3& eye, const std::vector<double>& distances) {
    std::vector<const CutRange*> drawn;
    std::bitset<256> levels;
    Cut cut;
    for (const CutRange& range : model_.ranges()) {
        if (range.corners.empty() || !isDrawn(range, eye, distances)) continue;
        drawn.push_back(&range);
        levels.set(static_cast<std::size_t>(range.level));
        cut.triangles += range.corners.size() / 3;
    }
    corners_.clear();
    for (const CutRange* range : drawn) {
        const double distance = morphDistance(*range, distances);
        for (const MorphVertex& vertex : range->corners) corners_.push_back(cornerAt(vertex, eye, distance));
    }
    cut.openEdges = openEdges(corners_);
    cut.levels = static_cast<int>(levels.count());
    return cut;
}

Cut CutDrawer::drawFull() {
    const std::vector<double> distances(static_cast<std::size_t>(model_.levels()), kFar);
    return draw(glm::dvec3(0), distances);
}

CrackReport countCracks(RangeModel model, const std::vector<double>& errors, const CrackOptions& options) {
    CutDrawer drawer(model);
    CrackReport report;
    report.full = drawer.drawFull();
    closeInput(model);
    report.looseBoxes = looseBoxes(model);
    report.vanished = model.vanished;
    report.leastTriangles = std::numeric_limits<std::uint64_t>::max();
    std::vector<double> diagonals = model.diagonals(options.diagonals == Diagonals::kLevelsAndInput);
    if (options.diagonals == Diagonals::kNone) std::ranges::fill(diagonals, 0.0);
    const LatticeBox bounds = model.bounds();
    std::mt19937_64 random(options.seed);
    for (std::size_t i = 0; i < options.pairs; ++i) {
        const glm::dvec3 eye = randomEye(random, bounds);
        const double screenError = logUniform(random, options.minScreenError, options.maxScreenError);
        const Cut cut = drawer.draw(eye, levelDistances(errors, diagonals, options.scale, screenError));
        report.openEdges += cut.openEdges;
        report.openCuts += cut.openEdges > 0 ? 1 : 0;
        report.twoLevels += cut.levels == 2 ? 1 : 0;
        report.moreLevels += cut.levels > 2 ? 1 : 0;
        report.triangles += cut.triangles;
        report.leastTriangles = std::min(report.leastTriangles, cut.triangles);
        report.mostTriangles = std::max(report.mostTriangles, cut.triangles);
    }
    return report;
}

}  // namespace iwalk::levels
