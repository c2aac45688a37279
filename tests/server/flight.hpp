#pragma once

#include <vector>

#include "common/camera_path.hpp"
#include "common/geometry.hpp"

namespace iwalk::tools {

// A path of `frames` cameras that shows what is hard for visibility: from outside through the walls to the
// middle and out again along a curve, turning the head all the while, with a jump of the eye at every
// quarter. `up`: an axis of the model.
std::vector<Camera> flight(const ModelBox& bounds, int frames, const glm::dvec3& up);

}  // namespace iwalk::tools
