#include "tests/tools/levels/deviation.hpp"

#include <algorithm>
#include <limits>

namespace iwalk::levels {
namespace {

Spread ratios(const std::vector<glm::dvec3>& points, const Surface& surface, double error) {
    std::vector<double> values = distances(points, surface);
    for (double& value : values) value /= error;
    return spreadOf(std::move(values));
}

}  // namespace

Reference::Reference(std::vector<FixedTriangle> triangles, const SampleOptions& options)
    : options_(options),
      points_(sampleArea(triangles, options.samples, options.seed)),
      surface_(std::move(triangles)) {}

double Deviation::largest() const {
    return std::max({fromFull.max, toFull.max, linesToFull.max});
}

double Deviation::p999() const {
    return std::max(fromFull.p999, toFull.p999);
}

Deviation deviationOf(std::vector<FixedTriangle> triangles, const Reference& full, double error) {
    Deviation result;
    if (triangles.empty()) {
        result.fromFull.p999 = result.fromFull.max = std::numeric_limits<double>::infinity();
        return result;
    }
    const SampleOptions& options = full.options();
    const auto points = sampleArea(triangles, options.samples, options.seed + 1);
    const auto lines = sampleLines(triangles, options.samples / 10, options.seed + 2);
    result.toFull = ratios(points, full.surface(), error);
    result.linesToFull = ratios(lines, full.surface(), error);
    const Surface surface(std::move(triangles));
    result.fromFull = ratios(full.points(), surface, error);
    return result;
}

}  // namespace iwalk::levels
