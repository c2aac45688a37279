#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "preprocess/opacity/cell_opacity.hpp"

// The coefficients against the share of random parallel rays that are blocked inside the cell, computed
// directly in double precision.
namespace iwalk {
namespace {

using Corners = std::vector<glm::vec3>;

struct Ray {
    glm::dvec3 origin, direction;
    double enter, leave;  // of the cell
};

// Where a ray is in the cell; false when it misses it.
bool crossCell(Ray& ray) {
    ray.enter = -std::numeric_limits<double>::infinity(), ray.leave = -ray.enter;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (ray.direction[axis] == 0) {
            if (ray.origin[axis] < 0 || ray.origin[axis] > 1) return false;
            continue;
        }
        const double a = (0 - ray.origin[axis]) / ray.direction[axis];
        const double b = (1 - ray.origin[axis]) / ray.direction[axis];
        ray.enter = std::max(ray.enter, std::min(a, b));
        ray.leave = std::min(ray.leave, std::max(a, b));
    }
    return ray.enter < ray.leave;
}

// Möller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection".
bool blocked(const Ray& ray, const glm::vec3* corners) {
    const glm::dvec3 a(corners[0]), ab = glm::dvec3(corners[1]) - a, ac = glm::dvec3(corners[2]) - a;
    const glm::dvec3 p = glm::cross(ray.direction, ac);
    const double determinant = glm::dot(ab, p);
    if (determinant == 0) return false;
    const glm::dvec3 s = ray.origin - a;
    const double u = glm::dot(s, p) / determinant;
    if (u < 0 || u > 1) return false;
    const glm::dvec3 q = glm::cross(s, ab);
    const double v = glm::dot(ray.direction, q) / determinant, depth = glm::dot(ac, q) / determinant;
    return v >= 0 && u + v <= 1 && depth >= ray.enter && depth <= ray.leave;
}

// Spheres around triangles: most rays are not near.
struct Sphere {
    glm::dvec3 center;
    double squaredRadius;
};

std::vector<Sphere> spheresOf(const Corners& corners) {
    std::vector<Sphere> spheres;
    for (std::size_t t = 0; t < corners.size(); t += 3) {
        Sphere sphere{glm::dvec3(corners[t] + corners[t + 1] + corners[t + 2]) / 3.0, 0};
        for (std::size_t i = t; i < t + 3; ++i) {
            const glm::dvec3 d = glm::dvec3(corners[i]) - sphere.center;
            sphere.squaredRadius = std::max(sphere.squaredRadius, 1.001 * glm::dot(d, d));
        }
        spheres.push_back(sphere);
    }
    return spheres;
}

bool near(const Ray& ray, const Sphere& sphere) {
    const glm::dvec3 d = sphere.center - ray.origin;
    const double along = glm::dot(d, ray.direction);
    return glm::dot(d, d) - along * along <= sphere.squaredRadius;
}

bool blocked(const Ray& ray, const Corners& corners, const std::vector<Sphere>& spheres) {
    for (std::size_t t = 0; t < spheres.size(); ++t) {
        if (near(ray, spheres[t]) && blocked(ray, &corners[3 * t])) return true;
    }
    return false;
}

// The share of `count` rays along a direction that are blocked in the cell.
double blockedShare(const Corners& corners, const glm::vec3& along, int count, std::mt19937& random) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(along));
    const glm::dvec3 right = glm::normalize(glm::cross(direction, glm::dvec3(0.1, 0.7, 0.3)));
    const glm::dvec3 up = glm::cross(right, direction);
    const std::vector<Sphere> spheres = spheresOf(corners);
    std::uniform_real_distribution<double> offset(-0.9, 0.9);
    int hits = 0;
    for (int i = 0; i < count;) {
        Ray ray{glm::dvec3(0.5) + offset(random) * right + offset(random) * up, direction, 0, 0};
        if (!crossCell(ray)) continue;
        ++i;
        hits += blocked(ray, corners, spheres) ? 1 : 0;
    }
    return static_cast<double>(hits) / count;
}

// Of coefficient - share over cells and directions.
struct Errors {
    double sum = 0, squares = 0, worst = 0;
    int count = 0;

    void add(const Corners& corners, int rays, std::mt19937& random) {
        CellOpacity cell;
        cell.add(corners);
        const auto coefficients = cell.coefficients();
        for (std::size_t i = 0; i < kOpacityAxes; ++i) {
            const double share = blockedShare(corners, kOpacityDirection[i], rays, random);
            const double error = coefficients[i] / 255.0 - share;
            sum += error, squares += error * error, worst = std::max(worst, std::abs(error)), ++count;
        }
    }
    double mean() const { return sum / count; }
    double rms() const { return std::sqrt(squares / count); }
};

// Random triangles of a size in cells, some reaching out of the cell.
Corners soup(std::size_t triangles, float size, std::mt19937& random) {
    std::uniform_real_distribution<float> place(0, 1), offset(-size / 2, size / 2);
    Corners corners;
    for (std::size_t i = 0; i < triangles; ++i) {
        const glm::vec3 center(place(random), place(random), place(random));
        for (int corner = 0; corner < 3; ++corner)
            corners.push_back(center + glm::vec3(offset(random), offset(random), offset(random)));
    }
    return corners;
}

// An orthonormal frame with a random first vector.
std::array<glm::vec3, 3> frame(std::mt19937& random) {
    std::normal_distribution<float> normal;
    const glm::vec3 a = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    const glm::vec3 b = glm::normalize(glm::cross(a, glm::vec3(normal(random), normal(random), 1)));
    return {a, b, glm::cross(a, b)};
}

// A rectangle of random tilt and place.
Corners plate(float size, std::mt19937& random) {
    const auto [normal, right, up] = frame(random);
    std::uniform_real_distribution<float> place(0.2f, 0.8f);
    const glm::vec3 center(place(random), place(random), place(random)), r = right * size, u = up * size;
    return {center - r - u, center + r - u, center + r + u, center - r - u, center + r + u, center - r + u};
}

// An open pipe through a random point, tessellated.
void addPipe(Corners& corners, float radius, std::mt19937& random) {
    const auto [axis, right, up] = frame(random);
    std::uniform_real_distribution<float> place(0.2f, 0.8f);
    const glm::vec3 center(place(random), place(random), place(random));
    constexpr int kSides = 12, kRings = 8;
    const auto point = [&, r = right, u = up, a = axis](int ring, int side) {
        const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(side % kSides) / kSides;
        const float along = 2.0f * static_cast<float>(ring) / kRings - 1;
        return center + a * along + radius * (r * std::cos(angle) + u * std::sin(angle));
    };
    for (int ring = 0; ring < kRings; ++ring) {
        for (int side = 0; side < kSides; ++side) {
            const glm::vec3 a = point(ring, side), b = point(ring + 1, side);
            const glm::vec3 c = point(ring + 1, side + 1), d = point(ring, side + 1);
            for (const glm::vec3& corner : {a, b, c, a, c, d}) corners.push_back(corner);
        }
    }
}

TEST(OpacityAgainstRays, SoupsOfEverySizeAreUnbiased) {
    // 0.004 cells is 0.15 pixels, where only one triangle in a hundred covers a centre.
    std::mt19937 random(11);
    for (const auto& [size, triangles] : {std::pair(0.004f, 1500), std::pair(0.01f, 1000),
                                          std::pair(0.03f, 500), std::pair(0.1f, 200), std::pair(0.6f, 20)}) {
        Errors errors;
        for (int cell = 0; cell < 8; ++cell)
            errors.add(soup(static_cast<std::size_t>(triangles), size, random), 2000, random);
        RecordProperty("soup_mean_" + std::to_string(size), std::to_string(errors.mean()));
        EXPECT_LT(std::abs(errors.mean()), 0.004) << size;
        EXPECT_LT(errors.rms(), 0.016) << size;
    }
}

TEST(OpacityAgainstRays, PlatesOfEveryTilt) {
    std::mt19937 random(12);
    Errors errors;
    for (int i = 0; i < 200; ++i) errors.add(plate(i % 2 == 0 ? 0.3f : 0.8f, random), 2000, random);
    RecordProperty("plates_mean", std::to_string(errors.mean()));
    EXPECT_LT(std::abs(errors.mean()), 0.002);
    EXPECT_LT(errors.rms(), 0.014);
    EXPECT_LT(errors.worst, 0.06);
}

TEST(OpacityAgainstRays, PipesOfEveryThickness) {
    // A tenth of a pixel to five pixels; many thin ones, as what is not 0 is stored as 1/255 or more.
    std::mt19937 random(13);
    for (const auto& [radius, pipes] : {std::pair(0.0013f, 20), std::pair(0.005f, 10), std::pair(0.02f, 3),
                                        std::pair(0.07f, 1), std::pair(0.3f, 1)}) {
        Errors errors;
        for (int i = 0; i < 120 / pipes; ++i) {
            Corners corners;
            for (int k = 0; k < pipes; ++k) addPipe(corners, radius, random);
            errors.add(corners, 2000, random);
        }
        RecordProperty("pipes_mean_" + std::to_string(radius), std::to_string(errors.mean()));
        EXPECT_LT(std::abs(errors.mean()), 0.0025) << radius;
        EXPECT_LT(errors.worst, 0.06) << radius;
    }
}

}  // namespace
}  // namespace iwalk
