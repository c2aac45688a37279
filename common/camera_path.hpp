#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "common/result.hpp"

namespace iwalk {

// What one eye sees on the whole wall. Model units; up need not be orthogonal to the view direction.
struct Camera {
    glm::dvec3 eye{0, 0, 0}, target{0, 0, -1}, up{0, 1, 0};
    double fovY = 60;  // vertical field of view of the whole wall, degrees, in (0, 180)
    bool operator==(const Camera&) const = default;
};

// Finite numbers, an eye away from its target, an up that is not along the view, a field of view in (1, 179).
Result<void> checkCamera(const Camera& camera);

// The JSON file of --path and --record: {"fov_y_deg": 60, "frames": [{"eye": [x,y,z], "target": [...], "up":
// [...]}]}
Result<std::vector<Camera>> loadCameraPath(const std::string& path);
Result<void> saveCameraPath(const std::string& path, const std::vector<Camera>& frames);

}  // namespace iwalk
