#include "client/fly/navigator.hpp"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

namespace iwalk::client {
namespace {

constexpr double kPi = std::numbers::pi;

ModelBox box(double edge = 10) {
    ModelBox bounds;
    bounds.add(glm::dvec3(0));
    bounds.add(glm::dvec3(edge));
    return bounds;
}

// At (5, -5, 2), looking north along y; up is z.
Navigator level() {
    Navigator navigator(box(), {0, 0, 1}, 60);
    navigator.go({{5, -5, 2}, {5, 0, 2}, {0, 0, 1}, 60});
    return navigator;
}

// For a while in small steps, and until it rests.
void fly(Navigator& navigator, const Motion& motion, double seconds) {
    for (double t = 0; t < seconds; t += 0.01) navigator.move(motion, 0.01);
    while (navigator.move({}, 0.01)) {
    }
}

glm::dvec3 viewOf(const Navigator& navigator) {
    return glm::normalize(navigator.camera().target - navigator.camera().eye);
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-9) {
    EXPECT_LE(glm::distance(a, b), tolerance)
        << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " " << b.z;
}

TEST(Navigator, KeysGoWhereTheyShould) {
    struct Case {
        Motion motion;
        glm::dvec3 way;
    };
    for (const Case& c :
         {Case{{.right = 1}, {1, 0, 0}}, Case{{.right = -1}, {-1, 0, 0}}, Case{{.up = 1}, {0, 0, 1}},
          Case{{.forward = 1}, {0, 1, 0}}, Case{{.forward = -1}, {0, -1, 0}}}) {
        Navigator navigator = level();
        const glm::dvec3 start = navigator.camera().eye;
        fly(navigator, c.motion, 0.5);
        const glm::dvec3 way = navigator.camera().eye - start;
        EXPECT_GT(glm::length(way), 0.1);
        expectNear(glm::normalize(way), c.way);
        expectNear(viewOf(navigator), {0, 1, 0});  // the target comes along
        EXPECT_NEAR(glm::distance(navigator.camera().eye, navigator.camera().target), 5, 1e-9);
    }
}

TEST(Navigator, ShiftIsFaster) {
    Navigator slow = level(), fast = level();
    slow.seeSurfaces(3, 3), fast.seeSurfaces(3, 3);
    fly(slow, {.right = 1}, 2);
    fly(fast, {.right = 1, .fast = true}, 2);
    EXPECT_NEAR((fast.camera().eye.x - 5) / (slow.camera().eye.x - 5), Navigator::kFast, 0.01);
}

TEST(Navigator, HowOftenItIsCalledDoesNotMatter) {
    Navigator often = level(), seldom = level();
    often.seeSurfaces(3, 3), seldom.seeSurfaces(3, 3);
    for (int i = 0; i < 3000; ++i) often.move({.right = 1}, 0.001);
    for (int i = 0; i < 100; ++i) seldom.move({.right = 1}, 0.03);
    EXPECT_NEAR(often.camera().eye.x, seldom.camera().eye.x, 0.05);
}

TEST(Navigator, APauseIsNoLeap) {
    Navigator navigator = level();
    navigator.seeSurfaces(3, 3);
    navigator.move({.forward = 1}, 60);
    EXPECT_LT(glm::distance(navigator.camera().eye, {5, -5, 2}), navigator.speed() * 0.11);
}

TEST(Navigator, MouseTurnsTheHead) {
    Navigator navigator = level();
    navigator.turn(kPi / 2, 0);
    expectNear(viewOf(navigator), {1, 0, 0});  // to the right: east
    navigator.turn(0, kPi / 4);
    expectNear(viewOf(navigator), glm::normalize(glm::dvec3(1, 0, 1)));
    expectNear(navigator.camera().eye, {5, -5, 2});
}

TEST(Navigator, LookingUpEndsBeforeTheZenith) {
    Navigator navigator = level();
    navigator.turn(0, 3 * kPi);
    EXPECT_TRUE(checkCamera(navigator.camera()).ok());
    EXPECT_GT(viewOf(navigator).z, 0.99);
    navigator.turn(0, -3 * kPi);
    EXPECT_LT(viewOf(navigator).z, -0.99);
    EXPECT_TRUE(checkCamera(navigator.camera()).ok());
}

TEST(Navigator, FlyingFollowsTheViewWalkingKeepsTheHeight) {
    Navigator navigator = level();
    navigator.turn(0, kPi / 4);
    fly(navigator, {.forward = 1}, 0.5);
    EXPECT_GT(navigator.camera().eye.z, 2.1);

    Navigator walker = level();
    walker.setWalking(true);
    walker.turn(0, kPi / 4);
    fly(walker, {.right = 0.5, .forward = 1}, 0.5);
    EXPECT_NEAR(walker.camera().eye.z, 2, 1e-12);
    EXPECT_GT(walker.camera().eye.y, -4.9);
    EXPECT_NEAR(viewOf(walker).z, std::sqrt(0.5), 1e-9);
    fly(walker, {.up = 1}, 0.5);  // but stairs are climbed
    EXPECT_GT(walker.camera().eye.z, 2.1);
}

TEST(Navigator, OrbitKeepsTheTargetAndTheDistance) {
    Navigator navigator = level();
    navigator.orbit(kPi / 2, 0);
    expectNear(navigator.camera().target, {5, 0, 2});
    expectNear(navigator.camera().eye, {0, 0, 2});  // from the west now
    navigator.orbit(0, -10);
    EXPECT_NEAR(glm::distance(navigator.camera().eye, navigator.camera().target), 5, 1e-9);
    EXPECT_GT(navigator.camera().eye.z, 6.9);  // from above
    EXPECT_TRUE(checkCamera(navigator.camera()).ok());
}

TEST(Navigator, OrbitIsAboutTheSurfacesAhead) {
    Navigator navigator = level();
    navigator.seeSurfaces(1, 7.5);
    navigator.beginOrbit();
    expectNear(navigator.camera().target, {5, 2.5, 2});
    navigator.seeSurfaces(0, 0);  // only sky: the target stays
    navigator.beginOrbit();
    expectNear(navigator.camera().target, {5, 2.5, 2});
}

TEST(Navigator, SpeedFollowsTheNearestSurfacesAndTheWheel) {
    Navigator navigator = level();
    navigator.seeSurfaces(4, 9);
    const double atFour = navigator.speed();
    navigator.seeSurfaces(0.04, 9);
    EXPECT_EQ(navigator.speed(), atFour);  // not at once
    for (int i = 0; i < 300; ++i) navigator.move({}, 0.01);
    EXPECT_NEAR(navigator.speed(), atFour / 100, atFour / 1000);
    navigator.changeSpeed(2);
    EXPECT_NEAR(navigator.speed(), atFour / 100 * Navigator::kWheelStep * Navigator::kWheelStep,
                atFour / 1000);
    navigator.changeSpeed(-1e6);
    EXPECT_GT(navigator.speed(), 0);
    navigator.changeSpeed(1e6);
    EXPECT_TRUE(std::isfinite(navigator.speed()));
}

TEST(Navigator, WithoutSurfacesTheModelsDistanceSetsTheSpeed) {
    Navigator near = level(), far = level();
    far.go({{5, -500, 2}, {5, 0, 2}, {0, 0, 1}, 60});
    EXPECT_GT(near.speed(), 0.1);
    EXPECT_GT(far.speed(), 2 * near.speed());
}

TEST(Navigator, HomeShowsTheWholeModel) {
    for (const glm::dvec3 up : {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0), glm::dvec3(-1, 0, 0)}) {
        const Navigator navigator(box(), up, 50);
        const Camera home = navigator.homeView();
        EXPECT_TRUE(checkCamera(home).ok());
        EXPECT_EQ(home, navigator.camera());
        EXPECT_EQ(home.up, up);
        const glm::dvec3 view = glm::normalize(home.target - home.eye);
        EXPECT_GT(glm::dot(home.eye - home.target, up), 0);  // from above
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 p(corner & 1 ? 10 : 0, corner & 2 ? 10 : 0, corner & 4 ? 10 : 0);
            const glm::dvec3 to = p - home.eye;
            const double depth = glm::dot(to, view);
            EXPECT_LT(glm::length(to - depth * view), depth * std::tan(25 * kPi / 180));
        }
    }
}

TEST(Navigator, ViewsFromElsewhereAreTakenAsTheyAre) {
    Navigator navigator = level();
    const Camera rolled{{1, 2, 3}, {1, 2, -5}, {1, 0, 0}, 90};  // straight down, top of the picture east
    navigator.go(rolled);
    EXPECT_EQ(navigator.camera().eye, rolled.eye);
    EXPECT_EQ(navigator.camera().up, rolled.up);
    EXPECT_EQ(navigator.camera().fovY, 60);
    navigator.turn(0, kPi / 2 - 0.01);  // up to the horizon: to the east
    EXPECT_GT(viewOf(navigator).x, 0.99);
    EXPECT_TRUE(checkCamera(navigator.camera()).ok());
}

TEST(Navigator, WhateverIsDoneTheCameraIsValid) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    for (const double edge : {1e-6, 1.0, 1e9}) {
        Navigator navigator(box(edge), {0, 0, 1}, 60);
        for (int i = 0; i < 20000; ++i) {
            navigator.move({any(random), any(random), any(random), any(random) > 0}, 0.1 * (any(random) + 1));
            if (i % 3 == 0) navigator.turn(3 * any(random), 3 * any(random));
            if (i % 5 == 0) navigator.orbit(3 * any(random), 3 * any(random));
            if (i % 7 == 0) navigator.changeSpeed(9 * any(random));
            if (i % 11 == 0)
                navigator.seeSurfaces(edge * std::pow(10, 5 * any(random)),
                                      edge * std::pow(10, 9 * any(random)));
            if (i % 13 == 0) navigator.beginOrbit();
            if (i % 17 == 0) navigator.setWalking(any(random) > 0);
            ASSERT_TRUE(checkCamera(navigator.camera()).ok()) << i;
        }
        EXPECT_LT(glm::length(navigator.camera().eye), 1000 * edge);
    }
}

TEST(Navigator, ModelsBeyondReckoningAreNone) {
    ModelBox huge;
    huge.add(glm::dvec3(-1e300)), huge.add(glm::dvec3(1e308));
    const Navigator navigator(huge, {0, 0, 1}, 60);
    EXPECT_TRUE(checkCamera(navigator.camera()).ok());
    EXPECT_TRUE(std::isfinite(navigator.speed()));
}

TEST(Navigator, EmptyModels) {
    Navigator navigator(ModelBox{}, {0, 0, 1}, 60);
    EXPECT_TRUE(checkCamera(navigator.camera()).ok());
    fly(navigator, {.forward = 1}, 1);
    EXPECT_TRUE(checkCamera(navigator.camera()).ok());
}

TEST(ParseUp, Axes) {
    EXPECT_EQ(parseUp("z").value(), glm::dvec3(0, 0, 1));
    EXPECT_EQ(parseUp("-y").value(), glm::dvec3(0, -1, 0));
    for (const char* bad : {"", "w", "zz", "-", "Z", "1"}) EXPECT_FALSE(parseUp(bad).ok()) << bad;
}

}  // namespace
}  // namespace iwalk::client
