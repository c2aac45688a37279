#include "tests/tools/ray_caster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <random>

#include "tests/tools/scenes.hpp"

namespace iwalk::tools {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Seen from +z towards the origin.
Camera cameraAt(double z, double fovY = 60) {
    return {{0, 0, z}, {0, 0, 0}, {0, 1, 0}, fovY};
}

TEST(PixelRays, RowsRunDownColumnsRightAndDepthIsOne) {
    const PixelRays rays({{1, 2, 3}, {1, 2, -7}, {0, 5, 1}, 90}, 4, 2);
    const Ray topLeft = rays.ray(0, 0);
    EXPECT_EQ(topLeft.origin, glm::dvec3(1, 2, 3));
    // Half the height is 1 at depth 1; the centre of the first pixel lies 1.5 to the left and 0.5 up.
    EXPECT_NEAR(glm::distance(topLeft.direction, glm::dvec3(-1.5, 0.5, -1)), 0, 1e-15);
    EXPECT_NEAR(glm::distance(rays.ray(3, 1).direction, glm::dvec3(1.5, -0.5, -1)), 0, 1e-15);
}

TEST(RayCaster, NothingIsHitInAnEmptyModel) {
    EXPECT_EQ(RayCaster({}).cast({{0, 0, 0}, {0, 0, -1}}, 0), Hit{});
}

TEST(RayCaster, DepthIsPerpendicularToTheScreenAndTwoSided) {
    const RayCaster front(box({-5, -5, -2}, {5, 5, 1}));
    const CastPicture picture = castPicture(front, cameraAt(4), 64, 48, 0);
    for (const double depth : picture.depth.pixels) EXPECT_NEAR(depth, 3, 1e-14);  // its face at z = 1
    // From inside: the back of the far face.
    EXPECT_NEAR(front.cast({{0, 0, 0}, {0.01, 0.02, -1}}, 0).depth, 2, 1e-15);
    // Behind the near plane's reach the front face is gone, the far one remains.
    EXPECT_NEAR(front.cast({{0, 0, 4}, {0, 0, -1}}, 3.5).depth, 6, 1e-14);
    EXPECT_NEAR(front.cast({{0, 0, 4}, {0, 0, -1}}, 3).depth, 3, 1e-14);
    EXPECT_EQ(front.cast({{0, 0, 4}, {0, 0, -1}}, 7), Hit{});
}

// Where a ray enters a sphere of this radius about `center`.
std::optional<double> sphereDepth(const Ray& ray, const glm::dvec3& center, double radius) {
    const glm::dvec3 o = ray.origin - center;
    const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(o, ray.direction);
    const double discriminant = b * b - a * (glm::dot(o, o) - radius * radius);
    if (discriminant < 0) return std::nullopt;
    return (-b - std::sqrt(discriminant)) / a;
}

// The faceted sphere lies between the sphere through its corners and the one within its faces.
void expectSphere(const glm::dvec3& center) {
    const Triangles triangles = moved(sphere(1, 5), center);
    double inner = 1;
    for (const auto& [a, b, c] : triangles) {
        const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
        inner = std::min(inner, std::abs(glm::dot(normal, a - center)));
    }
    Camera camera = cameraAt(3, 50);
    camera.eye += center, camera.target += center;
    const int width = 160, height = 120;
    const CastPicture picture = castPicture(RayCaster(triangles), camera, width, height, 0.1);
    const PixelRays rays(camera, width, height);
    int hits = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double depth = *picture.depth.at(x, y);
            const auto outer = sphereDepth(rays.ray(x, y), center, 1 + 1e-8);
            const auto within = sphereDepth(rays.ray(x, y), center, inner - 1e-8);
            EXPECT_EQ(within && depth == 0, false) << x << ", " << y;
            if (depth == 0) continue;
            ++hits;
            ASSERT_TRUE(outer) << x << ", " << y;
            EXPECT_GE(depth, *outer);
            EXPECT_LE(depth, within.value_or(kInfinity));
        }
    }
    EXPECT_GT(hits, 4000);
}

TEST(RayCaster, SphereIsWhereItShouldBe) {
    expectSphere({0, 0, 0});
}
TEST(RayCaster, SphereFarFromTheOriginToo) {
    expectSphere({1e7, -1e7, 1e7});
}

TEST(RayCaster, ThroughTheWindowOneSeesTheBackWall) {
    const glm::dvec3 offset{1e7, 2e7, -3e7};
    const Triangles room = moved(boxWithWindow({-2, -2, -4}, {2, 2, 0}, {-1, -0.5}, {1, 0.5}), offset);
    Camera camera = cameraAt(4);
    camera.eye += offset, camera.target += offset;
    const PixelRays rays(camera, 200, 160);
    const CastPicture picture = castPicture(RayCaster(room), camera, 200, 160, 0);
    for (int y = 0; y < 160; ++y) {
        for (int x = 0; x < 200; ++x) {
            // Where the ray crosses the planes of the front, the back and the sides.
            const glm::dvec3 d = rays.ray(x, y).direction, front = d * 4.0;
            const bool wall = std::abs(front.x) < 2 && std::abs(front.y) < 2;
            const bool window = std::abs(front.x) < 1 && std::abs(front.y) < 0.5;
            const double expected = !wall ? 0 : !window ? 4 : std::min(8.0, 2 / std::abs(d.x));
            EXPECT_NEAR(*picture.depth.at(x, y), expected, 1e-7) << x << ", " << y;
        }
    }
}

// Independent of the caster: Moeller and Trumbore 1997. `margin` becomes the distance of the hit to the
// triangle's border in barycentric coordinates, negative outside.
double mollerTrumbore(const Ray& ray, const Triangle& t, double& margin) {
    const glm::dvec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = glm::cross(ray.direction, e2);
    const double determinant = glm::dot(e1, p);
    const glm::dvec3 s = ray.origin - t[0], q = glm::cross(s, e1);
    const double u = glm::dot(s, p) / determinant, v = glm::dot(ray.direction, q) / determinant;
    margin = std::min({u, v, 1 - u - v});
    return glm::dot(e2, q) / determinant;
}

struct Answer {
    Hit hit;
    bool sure = true;  // no border so near that rounding decides
};

Answer bruteForce(const Triangles& triangles, const Ray& ray, double nearDepth) {
    Answer answer{{kInfinity, kNoTriangle}, true};
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        double margin = 0;
        const double depth = mollerTrumbore(ray, triangles[i], margin);
        if (std::abs(margin) < 1e-9 || std::abs(depth - nearDepth) < 1e-9) answer.sure = false;
        if (margin < 0 || depth <= 0 || depth < nearDepth || depth >= answer.hit.depth) continue;
        answer.hit = {depth, static_cast<std::uint32_t>(i)};
    }
    if (answer.hit.triangle == kNoTriangle) answer.hit = {};
    return answer;
}

Triangles soup(std::size_t count, double size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-1, 1);
    Triangles triangles(count);
    for (Triangle& triangle : triangles) {
        const glm::dvec3 center(place(random), place(random), place(random));
        for (glm::dvec3& corner : triangle) {
            corner = center + size * glm::dvec3(place(random), place(random), place(random));
        }
    }
    return triangles;
}

void expectBruteForce(const Triangles& triangles, const Camera& camera, double nearDepth) {
    const int width = 48, height = 36;
    const PixelRays rays(camera, width, height);
    const CastPicture picture = castPicture(RayCaster(triangles), camera, width, height, nearDepth);
    int sure = 0, hits = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Answer expected = bruteForce(triangles, rays.ray(x, y), nearDepth);
            if (!expected.sure) continue;
            ++sure;
            hits += expected.hit.triangle != kNoTriangle;
            EXPECT_EQ(*picture.triangle.at(x, y), expected.hit.triangle) << x << ", " << y;
            EXPECT_NEAR(*picture.depth.at(x, y), expected.hit.depth, 1e-9) << x << ", " << y;
        }
    }
    EXPECT_GT(sure, width * height * 9 / 10);
    EXPECT_GT(hits, 0);
}

TEST(RayCaster, EqualsTheLoopOverAllTriangles) {
    expectBruteForce(soup(1, 1, 1), cameraAt(3), 0);
    expectBruteForce(soup(5, 1, 2), cameraAt(3), 0);
    expectBruteForce(soup(1000, 0.2, 3), cameraAt(3), 0);
    expectBruteForce(soup(1000, 0.2, 4), cameraAt(0.3), 0.25);  // amid them
    Triangles mixed = soup(600, 0.05, 5);
    for (const Triangle& large : soup(20, 3, 6)) mixed.push_back(large);
    expectBruteForce(mixed, {{2, 1, 0.5}, {0, 0, 0}, {0, 0, 1}, 40}, 0);
}

TEST(RayCaster, ManyTrianglesInOnePlaceDoNotBreakTheTree) {
    const Triangle one{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}};
    Triangles same(1000, one);
    EXPECT_EQ(RayCaster(same).cast({{0, 0, 2}, {0, 0, -1}}, 0), (Hit{2, 0}));  // the first of equals
    // Ever smaller and nearer to a corner: the heuristic alone would make a list of this.
    Triangles nested;
    for (int i = 0; i < 900; ++i) {
        const double size = std::pow(0.5, i);
        nested.push_back({{{size, 0, -size}, {2 * size, 0, -size}, {size, size, -size}}});
    }
    const RayCaster caster(nested);
    EXPECT_EQ(caster.cast({{1.1, 0.1, 5}, {0, 0, -1}}, 0).triangle, 0u);
}

TEST(RayCaster, DegenerateTrianglesAreNotHit) {
    const RayCaster caster({{{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}, {{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}}});
    EXPECT_EQ(caster.cast({{0, 0, 1}, {0, 0, -1}}, 0), Hit{});
}

// Rays exactly through corners and along edges of a closed surface: none may slip through.
TEST(RayCaster, ClosedSurfacesAreWatertight) {
    const glm::dvec3 center{1e5, -3e4, 7};
    const Triangles triangles = moved(sphere(1, 4), center);
    const RayCaster caster(triangles);
    const glm::dvec3 eye = center + glm::dvec3(0.3, 0.2, 4);
    for (const Triangle& t : triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec3 &a = t[i], &b = t[(i + 1) % 3];
            for (double along : {0.0, 0.5, 1.0 / 3}) {
                const glm::dvec3 onEdge = a + along * (b - a);
                // From inside every ray must hit; from outside those that aim well within the silhouette.
                const Hit inside = caster.cast({center, onEdge - center}, 0);
                EXPECT_NEAR(inside.depth, 1, 1e-8);
                const Hit outside = caster.cast({eye, onEdge - eye}, 0);
                const bool wellWithin = glm::length(glm::dvec2(onEdge - center)) < 0.9;
                EXPECT_TRUE(outside.depth > 0 || !wellWithin);
            }
        }
    }
}

TEST(RayCaster, AxisParallelRaysInThePlanesOfBoxesHit) {
    const RayCaster caster(box({0, 0, 0}, {1, 1, 1}));
    for (const glm::dvec2 corner :
         {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0.5, 0)}) {
        EXPECT_EQ(caster.cast({{corner, 3}, {0, 0, -1}}, 0).depth, 2);
        EXPECT_EQ(caster.cast({{corner, -3}, {0, 0, 1}}, 0).depth, 3);
    }
}

TEST(RayCaster, ThreadsDoNotChangeThePicture) {
    const RayCaster caster(soup(2000, 0.3, 9));
    const CastPicture one = castPicture(caster, cameraAt(3), 64, 48, 0, 1);
    const CastPicture many = castPicture(caster, cameraAt(3), 64, 48, 0, 7);
    EXPECT_EQ(one.depth.pixels, many.depth.pixels);
    EXPECT_EQ(one.triangle.pixels, many.triangle.pixels);
}

}  // namespace
}  // namespace iwalk::tools
