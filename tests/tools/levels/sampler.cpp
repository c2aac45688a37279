#include "tests/tools/levels/sampler.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/tools/levels/parallel.hpp"

namespace iwalk::levels {
namespace {

bool isLine(const FixedTriangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

double lineLength(const FixedTriangle& t) {
    if (!isLine(t)) return 0;
    const auto line = lineOf(t);
    return glm::length(toDouble(line[1]) - toDouble(line[0]));
}

using Random = std::mt19937_64;

double uniform(Random& random) {
    return std::uniform_real_distribution<double>(0, 1)(random);
}

// Uniform on a triangle; Turk 1990, "Generating random points in triangles".
glm::dvec3 pointOnTriangle(const FixedTriangle& t, Random& random) {
    const double s = std::sqrt(uniform(random)), u = uniform(random);
    return (1 - s) * toDouble(t[0]) + s * (1 - u) * toDouble(t[1]) + s * u * toDouble(t[2]);
}

glm::dvec3 pointOnLine(const FixedTriangle& t, Random& random) {
    const auto line = lineOf(t);
    return glm::mix(toDouble(line[0]), toDouble(line[1]), uniform(random));
}

// One point in each of `count` parts of equal measure, in one pass over the triangles.
template <class Measure, class Point>
std::vector<glm::dvec3> stratified(const std::vector<FixedTriangle>& triangles, std::size_t count,
                                   std::uint64_t seed, const Measure& measure, const Point& point) {
    double total = 0;
    for (const FixedTriangle& t : triangles) total += measure(t);
    std::vector<glm::dvec3> points;
    if (total <= 0 || count == 0) return points;
    Random random(seed);
    const double part = total / static_cast<double>(count);
    double passed = 0, next = uniform(random) * part;
    for (const FixedTriangle& t : triangles) {
        passed += measure(t);
        for (; next < passed && points.size() < count;
             next = (static_cast<double>(points.size()) + uniform(random)) * part)
            points.push_back(point(t, random));
    }
    return points;
}

}  // namespace

std::vector<glm::dvec3> sampleArea(const std::vector<FixedTriangle>& triangles, std::size_t count,
                                   std::uint64_t seed) {
    return stratified(triangles, count, seed, areaOf, pointOnTriangle);
}

std::vector<glm::dvec3> sampleLines(const std::vector<FixedTriangle>& triangles, std::size_t count,
                                    std::uint64_t seed) {
    return stratified(triangles, count, seed, lineLength, pointOnLine);
}

std::vector<double> distances(const std::vector<glm::dvec3>& points, const Surface& surface) {
    std::vector<double> result(points.size());
    forParts(points.size(), 0, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) result[i] = surface.distance(points[i]);
    });
    return result;
}

Spread spreadOf(std::vector<double> values) {
    if (values.empty()) return {};
    std::ranges::sort(values);
    const auto at = [&](double share) {
        const double rank = std::ceil(share * static_cast<double>(values.size()));
        return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
    };
    return {at(0.5), at(0.99), at(0.999), values.back()};
}

}  // namespace iwalk::levels
