#pragma once

#include <glm/vec3.hpp>

#include "common/camera_path.hpp"
#include "common/geometry.hpp"
#include "common/result.hpp"

namespace iwalk::client {

// "x", "y", "z", "-x", "-y" or "-z".
Result<glm::dvec3> parseUp(const std::string& text);

// Which way a person wants to go, each from -1 to 1.
struct Motion {
    double right = 0, up = 0, forward = 0;
    bool fast = false;
};

// Moves a camera as hands on a keyboard and a mouse ask for. Pure: no clock, no window, no network.
//
// The horizon stays level: `up` is the model's. Speed is in proportion to how far the nearest surfaces are,
// so one setting suits a screw and a city; the servers report that distance with every frame.
class Navigator {
  public:
    static constexpr double kFast = 4;              // times as fast
    static constexpr double kWheelStep = 1.25;      // a step of the wheel
    static constexpr double kSettleSeconds = 0.08;  // for two thirds of a change of velocity

    // `up`: a unit vector. `fovY`: degrees. Begins at home.
    Navigator(const ModelBox& bounds, const glm::dvec3& up, double fovY);

    const Camera& camera() const { return camera_; }
    // All of the model from outside, from a little above.
    Camera homeView() const;
    void setFovY(double degrees) { camera_.fovY = degrees; }
    // Goes there at once; the field of view stays.
    void go(const Camera& view);

    // Walking keeps the height: looking up or down does not lift or sink.
    void setWalking(bool walking) { walking_ = walking; }
    bool walking() const { return walking_; }

    // Of the picture: how far its nearest surfaces are, and those in the middle of its range. Model units; 0:
    // there are none.
    void seeSurfaces(double nearDepth, double midDepth);

    // A step of the clock. True while the camera moves.
    bool move(const Motion& wanted, double seconds);
    // Radians: where to look.
    void turn(double right, double up);
    // Puts the target at the surfaces ahead; orbit() then turns about it.
    void beginOrbit();
    void orbit(double right, double up);

    void changeSpeed(double wheelSteps);
    double speed() const;  // model units per second

  private:
    struct Angles {
        double yaw = 0, pitch = 0;  // radians; yaw counterclockwise seen from above
    };
    glm::dvec3 forward() const;
    Angles anglesOf(const glm::dvec3& direction) const;
    glm::dvec3 directionOf(const Angles& angles) const;
    glm::dvec3 turned(double right, double up) const;
    double targetDistance() const;
    double distanceToBounds() const;
    double distanceToSee(const glm::dvec3& looking) const;
    void lookAlong(const glm::dvec3& direction, double distance);
    void stayNear();

    const ModelBox bounds_;
    const double size_;                   // of the model's diagonal
    const glm::dvec3 up_, east_, north_;  // a right-handed frame
    Camera camera_;
    bool walking_ = false;
    double speedFactor_ = 0.6;  // of the distance of surfaces, per second
    double nearDepth_ = 0, midDepth_ = 0;
    double smoothDepth_ = 0;  // nearDepth_ without its jumps
    glm::dvec3 velocity_{0};  // right, up, forward: of speed()
};

}  // namespace iwalk::client
