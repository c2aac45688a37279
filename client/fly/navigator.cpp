#include "client/fly/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace iwalk::client {
namespace {

constexpr double kMaxPitch = 89 * std::numbers::pi / 180;  // beyond, the roll would be undefined
constexpr double kDepthSeconds = 0.3;                      // for two thirds of a change of surfaces' distance
constexpr double kLongestStep = 0.1;                       // s; after a pause nobody wants to be elsewhere
constexpr double kStandstill = 0.005;                      // of the speed
constexpr double kNearest = 1e-5, kFarthest = 1;  // of the model's size: surfaces' distance, for the speed
constexpr double kShortestTarget = 1e-6;          // of the model's size
constexpr double kFarAway = 100;                  // of the model's size: nobody gets farther from it

// Of a change, after `seconds`.
double share(double seconds, double settle) {
    return 1 - std::exp(-seconds / settle);
}

glm::dvec3 across(const glm::dvec3& up) {
    const glm::dvec3 axis = std::abs(up.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::normalize(axis - glm::dot(axis, up) * up);
}

// A server may say anything of its model; what is no box, or beyond reckoning, is none.
ModelBox reasonable(const ModelBox& box) {
    constexpr double kFar = 1e15;
    const bool fine = !box.empty() && glm::length(box.min) < kFar && glm::length(box.max) < kFar;
    return fine ? box : ModelBox();
}

glm::dvec3 middle(const ModelBox& box) {
    return box.empty() ? glm::dvec3(0) : box.min + (box.max - box.min) * 0.5;
}

}  // namespace

Result<glm::dvec3> parseUp(const std::string& text) {
    const bool minus = text.starts_with('-');
    const std::string axis = minus ? text.substr(1) : text;
    if (axis != "x" && axis != "y" && axis != "z") return fail("'{}' is not x, y, z, -x, -y or -z", text);
    glm::dvec3 up(0);
    up[static_cast<std::size_t>(axis[0] - 'x')] = minus ? -1 : 1;
    return up;
}

Navigator::Navigator(const ModelBox& bounds, const glm::dvec3& up, double fovY)
    : bounds_(reasonable(bounds)),
      size_(bounds_.empty() || bounds_.min == bounds_.max ? 1 : glm::distance(bounds_.min, bounds_.max)),
      up_(up),
      east_(across(up)),
      north_(glm::cross(up, east_)) {
    camera_.fovY = fovY;
    camera_ = homeView();
}

Camera Navigator::homeView() const {
    Camera view;
    view.fovY = camera_.fovY;
    view.target = middle(bounds_);
    const glm::dvec3 looking = directionOf({1.2, -0.45});
    view.eye = view.target - distanceToSee(looking) * looking;
    view.up = up_;
    return view;
}

// From the middle, so that a cone as wide as the picture is high holds all of the model.
double Navigator::distanceToSee(const glm::dvec3& looking) const {
    const double slope = std::tan(camera_.fovY / 2 * std::numbers::pi / 180);
    double distance = 0.01 * size_;
    for (int i = 0; i < 8 && !bounds_.empty(); ++i) {
        const ModelBox& box = bounds_;
        const glm::dvec3 corner(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                                i & 4 ? box.max.z : box.min.z);
        const glm::dvec3 from = corner - middle(box);
        const double along = glm::dot(from, looking);
        distance = std::max(distance, glm::length(from - along * looking) / slope - along);
    }
    return 1.02 * distance;
}

void Navigator::go(const Camera& view) {
    const double fovY = camera_.fovY;
    camera_ = view;
    camera_.fovY = fovY;
    velocity_ = glm::dvec3(0);
}

void Navigator::seeSurfaces(double nearDepth, double midDepth) {
    nearDepth_ = nearDepth;
    midDepth_ = midDepth;
    if (smoothDepth_ == 0) smoothDepth_ = nearDepth;
}

glm::dvec3 Navigator::forward() const {
    return glm::normalize(camera_.target - camera_.eye);
}

double Navigator::targetDistance() const {
    return std::max(glm::distance(camera_.target, camera_.eye), kShortestTarget * size_);
}

double Navigator::distanceToBounds() const {
    if (bounds_.empty()) return size_;
    return glm::distance(camera_.eye, glm::clamp(camera_.eye, bounds_.min, bounds_.max));
}

Navigator::Angles Navigator::anglesOf(const glm::dvec3& direction) const {
    Angles angles;
    angles.pitch = std::asin(std::clamp(glm::dot(direction, up_), -1.0, 1.0));
    glm::dvec3 level = direction - glm::dot(direction, up_) * up_;
    // Straight up or down the top of the picture says where to.
    if (glm::length(level) < 1e-6) level = camera_.up * (angles.pitch > 0 ? -1.0 : 1.0);
    angles.yaw = std::atan2(glm::dot(level, north_), glm::dot(level, east_));
    return angles;
}

glm::dvec3 Navigator::directionOf(const Angles& angles) const {
    const glm::dvec3 level = std::cos(angles.yaw) * east_ + std::sin(angles.yaw) * north_;
    return std::cos(angles.pitch) * level + std::sin(angles.pitch) * up_;
}

glm::dvec3 Navigator::turned(double right, double up) const {
    Angles angles = anglesOf(forward());
    angles.yaw -= right;
    angles.pitch = std::clamp(angles.pitch + up, -kMaxPitch, kMaxPitch);
    return directionOf(angles);
}

void Navigator::lookAlong(const glm::dvec3& direction, double distance) {
    camera_.target = camera_.eye + distance * direction;
    camera_.up = up_;
}

void Navigator::turn(double right, double up) {
    lookAlong(turned(right, up), targetDistance());
}

void Navigator::beginOrbit() {
    if (midDepth_ <= 0) return;
    camera_.target = camera_.eye + std::max(midDepth_, kShortestTarget * size_) * forward();
}

void Navigator::orbit(double right, double up) {
    const double distance = targetDistance();
    camera_.eye = camera_.target - distance * turned(right, up);
    camera_.up = up_;
    stayNear();
}

void Navigator::changeSpeed(double wheelSteps) {
    speedFactor_ = std::clamp(speedFactor_ * std::pow(kWheelStep, wheelSteps), 0.01, 100.0);
}

double Navigator::speed() const {
    const double unknown = distanceToBounds() + 0.05 * size_;
    const double depth = smoothDepth_ > 0 ? smoothDepth_ : unknown;
    return speedFactor_ * std::clamp(depth, kNearest * size_, kFarthest * size_);
}

bool Navigator::move(const Motion& wanted, double seconds) {
    const double step = std::clamp(seconds, 0.0, kLongestStep);
    // A pole that passes by must not stop the flight: depths are taken in gradually, as ratios.
    if (nearDepth_ > 0 && smoothDepth_ > 0)
        smoothDepth_ *= std::pow(nearDepth_ / smoothDepth_, share(step, kDepthSeconds));
    if (nearDepth_ <= 0) smoothDepth_ = 0;

    const glm::dvec3 towards =
        glm::dvec3(wanted.right, wanted.up, wanted.forward) * (wanted.fast ? kFast : 1.0);
    velocity_ += (towards - velocity_) * share(step, kSettleSeconds);
    if (towards == glm::dvec3(0) && glm::length(velocity_) < kStandstill) velocity_ = glm::dvec3(0);
    if (velocity_ == glm::dvec3(0)) return false;

    const double distance = targetDistance();
    const Angles angles = anglesOf(forward());
    const glm::dvec3 ahead = walking_ ? directionOf({angles.yaw, 0}) : forward();
    const glm::dvec3 right = directionOf({angles.yaw - std::numbers::pi / 2, 0});
    const glm::dvec3 looking = forward();
    camera_.eye += (velocity_.x * right + velocity_.y * up_ + velocity_.z * ahead) * (speed() * step);
    stayNear();
    camera_.target = camera_.eye + distance * looking;
    return true;
}

void Navigator::stayNear() {
    const glm::dvec3 reach(kFarAway * size_);
    camera_.eye = glm::clamp(camera_.eye, middle(bounds_) - reach, middle(bounds_) + reach);
}

}  // namespace iwalk::client
