#include "tests/tools/levels/views.hpp"

#include <cmath>
#include <glm/trigonometric.hpp>

#include "tests/tools/ray_caster.hpp"

namespace iwalk::levels {
namespace {

constexpr double kFovY = 60;  // degrees

// Whether all pixels within `reach` px of (x, y) show something.
bool isCovered(const Image<double>& depth, int x, int y, int reach) {
    for (int v = y - reach; v <= y + reach; ++v) {
        for (int u = x - reach; u <= x + reach; ++u) {
            if (u < 0 || v < 0 || u >= depth.width || v >= depth.height || *depth.at(u, v) == 0) return false;
        }
    }
    return true;
}

}  // namespace

ViewReport countHoles(const RangeModel& model, const std::vector<double>& errors,
                      const ViewOptions& options) {
    const CutDrawer drawer(model);
    const std::vector<double> finest(errors.size(), 1e300);  // everything is nearer than its level begins
    const tools::RayCaster input(drawer.triangles(glm::dvec3(0), finest));
    const std::vector<double> diagonals = model.diagonals(false);
    const LatticeBox bounds = model.bounds();
    // What a length measures in pixels is most in the picture's corners.
    const double half = std::tan(glm::radians(kFovY) / 2);
    const double scale = options.size / 2.0 / half * (1 + 2 * half * half);
    std::mt19937_64 random(options.seed);
    ViewReport report;
    for (std::size_t i = 0; i < options.views; ++i) {
        Camera camera{randomEye(random, bounds), {}, {0, 0, 1}, kFovY};
        for (glm::length_t axis = 0; axis < 3; ++axis) {
            camera.target[axis] = std::uniform_real_distribution<double>(
                static_cast<double>(bounds.min[axis]), static_cast<double>(bounds.max[axis]))(random);
        }
        const double screenError = logUniform(random, options.minScreenError, options.maxScreenError);
        auto triangles = drawer.triangles(camera.eye, levelDistances(errors, diagonals, scale, screenError));
        report.triangles += triangles.size();
        const tools::RayCaster cut(std::move(triangles));
        const Image<double> seen = castPicture(cut, camera, options.size, options.size, 0).depth;
        const Image<double> reference = castPicture(input, camera, options.size, options.size, 0).depth;
        const int reach = static_cast<int>(std::ceil(screenError)) + 1;
        for (int y = 0; y < options.size; ++y) {
            for (int x = 0; x < options.size; ++x) {
                if (!isCovered(reference, x, y, reach)) continue;
                ++report.covered;
                report.holes += *seen.at(x, y) == 0 ? 1 : 0;
            }
        }
    }
    return report;
}

}  // namespace iwalk::levels
