#include "common/camera_path.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtx/component_wise.hpp>
#include <nlohmann/json.hpp>

#include "common/file.hpp"

namespace iwalk {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMaxPathBytes = 256u << 20;  // over a million frames
constexpr double kMinSine = 1e-6;  // of the angle between up and the view direction: below, the roll is noise

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

double largest(const glm::dvec3& v) {
    return glm::compMax(glm::abs(v));
}

// Of length 1 without overflow on the way; zero for a zero vector or one that is not finite.
glm::dvec3 direction(const glm::dvec3& v) {
    const double scale = largest(v);
    if (!(scale > 0) || !std::isfinite(scale)) return glm::dvec3(0);
    return glm::normalize(v / scale);
}

Result<glm::dvec3> readVector(const json& frame, const char* key) {
    const auto found = frame.find(key);
    if (found == frame.end()) return fail("\"{}\" is missing", key);
    const bool numbers =
        found->is_array() && found->size() == 3 &&
        std::all_of(found->begin(), found->end(), [](const json& n) { return n.is_number(); });
    if (!numbers) return fail("\"{}\" is not an array of three numbers", key);
    return glm::dvec3((*found)[0].get<double>(), (*found)[1].get<double>(), (*found)[2].get<double>());
}

Result<Camera> readFrame(const json& frame, double fovY) {
    if (!frame.is_object()) return fail("not an object with eye, target and up");
    Camera camera;
    camera.fovY = fovY;
    ASSIGN_OR_RETURN(camera.eye, readVector(frame, "eye"));
    ASSIGN_OR_RETURN(camera.target, readVector(frame, "target"));
    ASSIGN_OR_RETURN(camera.up, readVector(frame, "up"));
    RETURN_IF_ERROR(checkCamera(camera));
    return camera;
}

Result<std::vector<Camera>> readFrames(const json& document) {
    if (!document.is_object()) return fail("not an object with fov_y_deg and frames");
    const auto fov = document.find("fov_y_deg");
    if (fov == document.end() || !fov->is_number())
        return fail("\"fov_y_deg\", a number of degrees, is missing");
    const auto frames = document.find("frames");
    if (frames == document.end() || !frames->is_array()) return fail("\"frames\", an array, is missing");
    if (frames->empty()) return fail("\"frames\" is empty");

    std::vector<Camera> path;
    path.reserve(frames->size());
    for (const json& frame : *frames) {
        Result<Camera> camera = readFrame(frame, fov->get<double>());
        if (!camera) return fail("frame {}: {}", path.size(), camera.error().message);
        path.push_back(*camera);
    }
    return path;
}

json writeVector(const glm::dvec3& v) {
    return json::array({v.x, v.y, v.z});
}

}  // namespace

Result<void> checkCamera(const Camera& camera) {
    if (!finite(camera.eye) || !finite(camera.target) || !finite(camera.up) || !std::isfinite(camera.fovY)) {
        return fail("a camera number is not finite");
    }
    if (camera.fovY <= 1 || camera.fovY >= 179) {
        return fail("the field of view is {} degrees; it must be between 1 and 179", camera.fovY);
    }
    const glm::dvec3 view = direction(camera.target - camera.eye);
    if (view == glm::dvec3(0)) return fail("the eye is at its target (or out of reach of it)");
    const glm::dvec3 up = direction(camera.up);
    if (up == glm::dvec3(0)) return fail("the up vector is zero");
    if (glm::length(glm::cross(view, up)) < kMinSine) return fail("the up vector points along the view");
    return {};
}

Result<std::vector<Camera>> loadCameraPath(const std::string& path) {
    ASSIGN_OR_RETURN(const std::string text, readWholeFile(path, kMaxPathBytes));
    json document;
    try {
        document = json::parse(text);
    } catch (const json::parse_error& error) {
        return fail("{}: not JSON, at byte {}: {}", path, error.byte, error.what());
    } catch (const json::exception& error) {
        return fail("{}: not a camera path: {}", path, error.what());
    }
    Result<std::vector<Camera>> frames = readFrames(document);
    if (!frames) return fail("{}: {}", path, frames.error().message);
    return frames;
}

Result<void> saveCameraPath(const std::string& path, const std::vector<Camera>& frames) {
    if (frames.empty()) return fail("{}: a camera path needs at least one frame", path);
    json document = {{"fov_y_deg", frames.front().fovY}, {"frames", json::array()}};
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const Result<void> checked = checkCamera(frames[i]);
        if (!checked) return fail("{}: frame {}: {}", path, i, checked.error().message);
        // The file has one field of view for all frames.
        if (frames[i].fovY != frames.front().fovY)
            return fail("{}: frame {}: another field of view", path, i);
        document["frames"].push_back({{"eye", writeVector(frames[i].eye)},
                                      {"target", writeVector(frames[i].target)},
                                      {"up", writeVector(frames[i].up)}});
    }
    return replaceFile(path, document.dump(1) + "\n");
}

}  // namespace iwalk
