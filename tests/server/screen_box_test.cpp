#include "server/visibility/screen_box.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

namespace iwalk {
namespace {

// What the vertex shader makes of a point, in its floats.
struct Vertex {
    glm::vec2 onScreen;
    float depth = 0, distance = 0;
};
Vertex shade(const ScreenProjection& projection, float near, const glm::dvec3& point) {
    const glm::vec3 q = glm::mat3(projection.toPixels) * glm::vec3(point);
    return {glm::round(glm::vec2(q) / q.z * 256.0f) * (1.0f / 256), near / q.z, q.z};
}

class ScreenBoxTest : public ::testing::Test {
  protected:
    double number(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    glm::dvec3 point(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
    Camera camera(double fovY) { return {point(1), point(1), point(1), fovY}; }
    static Wall wall(int width, int height) {
        Wall wall;
        wall.width = width;
        wall.height = height;
        return wall;
    }
    static constexpr int kFar = 1000000;  // px
    std::mt19937 random_{5};
};

// Every pixel whose centre a triangle in the box may cover lies between those of its corners; every depth at
// its corners is one that the box allows.
TEST_F(ScreenBoxTest, ContainsWhateverTheShaderMakesOfTheBox) {
    int tested = 0;
    for (int round = 0; round < 4000; ++round) {
        const double fov = std::exp(number(std::log(1.01), std::log(178)));
        const int edge = round % 3 == 0 ? 16384 : 1024;
        const Camera view = camera(fov);
        const ScreenProjection projection = projectScreen(wall(edge, edge).screens(fov)[0], view);
        const double near = 0.01;
        const glm::dvec3 low = point(3), high = low + glm::abs(point(std::pow(10, number(-5, 0.5))));
        const BoxProjection boxes(projection, {-kFar, -kFar, 2 * kFar, 2 * kFar}, near);
        const ScreenBox box = boxes.of(low, high);
        for (int i = 0; i < 20; ++i) {
            const glm::dvec3 in = glm::mix(low, high, glm::dvec3(i & 1, i >> 1 & 1, i >> 2 & 1));
            const Vertex vertex = shade(projection, static_cast<float>(near),
                                        i < 8 ? in : glm::mix(low, high, glm::abs(point(1))));
            if (vertex.distance < near) {
                ASSERT_EQ(box.depth, ScreenBox::kAtTheEye);
                continue;
            }
            ASSERT_LE(vertex.depth, box.depth);
            if (glm::any(glm::greaterThan(glm::abs(vertex.onScreen), glm::vec2(0.9f * kFar)))) continue;
            ++tested;
            ASSERT_LE(static_cast<float>(box.left - kFar), std::ceil(vertex.onScreen.x - 0.5f));
            ASSERT_GE(static_cast<float>(box.right - kFar), std::floor(vertex.onScreen.x - 0.5f) + 1);
            ASSERT_LE(static_cast<float>(box.top - kFar), std::ceil(vertex.onScreen.y - 0.5f));
            ASSERT_GE(static_cast<float>(box.bottom - kFar), std::floor(vertex.onScreen.y - 0.5f) + 1);
        }
    }
    EXPECT_GT(tested, 10000);
}

const Camera kAhead{{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90};

TEST_F(ScreenBoxTest, IsTight) {
    const ScreenProjection projection = projectScreen(wall(200, 200).screens(90)[0], kAhead);
    const BoxProjection boxes(projection, {50, 0, 100, 200}, 0.5);
    const ScreenBox box = boxes.of({-1, -2, -20}, {1, 2, -10});  // 10 px to a unit at the near side
    EXPECT_EQ(box.left, 40);
    EXPECT_EQ(box.right, 60);
    EXPECT_EQ(box.top, 80);
    EXPECT_EQ(box.bottom, 120);
    EXPECT_NEAR(box.depth, 0.05, 1e-6);
    EXPECT_TRUE(boxes.of({-60, 0, -20}, {-50, 1, -10}).empty());
}

TEST_F(ScreenBoxTest, ABoxAcrossTheNearPlaneCoversAll) {
    const ScreenProjection projection = projectScreen(wall(200, 200).screens(90)[0], kAhead);
    const BoxProjection boxes(projection, {50, 0, 100, 200}, 0.5);
    for (const double nearest : {-0.5, -0.1, 0.5}) {
        const ScreenBox box = boxes.of({-1, -2, -20}, {1, 2, nearest});
        EXPECT_EQ(box.depth, ScreenBox::kAtTheEye);
        EXPECT_EQ(box.right - box.left, 100);
        EXPECT_EQ(box.bottom - box.top, 200);
    }
}

}  // namespace
}  // namespace iwalk
