#include "tests/server/flight.hpp"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace iwalk::tools {

std::vector<Camera> flight(const ModelBox& bounds, int frames, const glm::dvec3& up) {
    const glm::dvec3 middle = 0.5 * (bounds.min + bounds.max), half = 0.5 * (bounds.max - bounds.min);
    const glm::dvec3 side(up.y, up.z, up.x), ahead(up.z, up.x, up.y);
    std::vector<Camera> path;
    for (int i = 0; i < frames; ++i) {
        const double t = static_cast<double>(i) / frames;
        const double quarter = std::floor(4 * t), within = 4 * t - quarter;
        // Radius from 1.6 times the model to its middle and back; each quarter begins somewhere else.
        const double angle = 2 * std::numbers::pi * (0.11 + 0.31 * quarter + 0.12 * within);
        const double radius = 1.6 * std::abs(1 - 2 * within);
        const double height = 0.7 * std::sin(5 * angle + within);
        const glm::dvec3 place = radius * (std::cos(angle) * side + std::sin(angle) * ahead) + height * up;
        const double gaze = angle + std::numbers::pi + 1.5 * std::sin(9 * within);
        const glm::dvec3 view = std::cos(gaze) * side + std::sin(gaze) * ahead - 0.4 * height * up;
        Camera camera;
        camera.eye = middle + place * half;
        camera.target = camera.eye + glm::length(half) * view;
        camera.up = up;
        camera.fovY = 60;
        path.push_back(camera);
    }
    return path;
}

}  // namespace iwalk::tools
