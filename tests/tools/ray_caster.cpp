#include "tests/tools/ray_caster.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include "common/check.hpp"

// Ray against triangle: Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection", in double and
// without their fallback to higher precision: an edge function of exactly 0 counts as inside for both
// neighbours.
namespace iwalk::tools {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A ray prepared for many tests: axes turned so that z is the longest, then sheared so that it runs along z.
struct ShearedRay {
    glm::dvec3 origin, inverse;  // inverse of the direction; infinite where that is 0
    std::size_t kx, ky, kz;
    double sx, sy, sz;

    explicit ShearedRay(const Ray& ray) : origin(ray.origin), inverse(1.0 / ray.direction) {
        const glm::dvec3 size = glm::abs(ray.direction);
        kz = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        kx = (kz + 1) % 3;
        ky = (kx + 1) % 3;
        sx = ray.direction[kx] / ray.direction[kz];
        sy = ray.direction[ky] / ray.direction[kz];
        sz = 1 / ray.direction[kz];
    }

    glm::dvec3 shear(const glm::dvec3& point) const {
        const glm::dvec3 p = point - origin;
        return {p[kx] - sx * p[kz], p[ky] - sy * p[kz], sz * p[kz]};
    }
};

std::optional<double> intersect(const ShearedRay& ray, const Triangle& triangle) {
    const glm::dvec3 a = ray.shear(triangle[0]), b = ray.shear(triangle[1]), c = ray.shear(triangle[2]);
    // Edge functions; an edge's two triangles compute the same products, so they agree on its side.
    const double u = c.x * b.y - c.y * b.x, v = a.x * c.y - a.y * c.x, w = b.x * a.y - b.y * a.x;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
    const double sum = u + v + w;
    if (sum == 0) return std::nullopt;  // seen from its edge, or degenerate
    return (u * a.z + v * b.z + w * c.z) / sum;
}

// How far `intersect` may see outside a box by rounding: some units in the last place of the largest
// difference.
double paddingFor(const ModelBox& box, const glm::dvec3& origin) {
    const glm::dvec3 reach = glm::max(glm::abs(box.min - origin), glm::abs(box.max - origin));
    return 1e-14 * std::max({reach.x, reach.y, reach.z});
}

// The depth at which the ray enters the box, no less than 0; infinite when it misses it or enters beyond
// `limit`.
double entry(const ShearedRay& ray, const ModelBox& box, double padding, double limit) {
    double enter = 0, leave = limit;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // In this order: far from the origin the padding would be lost in a coordinate.
        const double low = (box.min[axis] - ray.origin[axis] - padding) * ray.inverse[axis];
        const double high = (box.max[axis] - ray.origin[axis] + padding) * ray.inverse[axis];
        // 0 times infinity is NaN, in the plane of a side: such a comparison is false and leaves the bound
        // alone.
        const double first = ray.inverse[axis] < 0 ? high : low, last = ray.inverse[axis] < 0 ? low : high;
        if (first > enter) enter = first;
        if (last < leave) leave = last;
    }
    return enter <= leave ? enter : kInfinity;
}

}  // namespace

PixelRays::PixelRays(const Camera& camera, int width, int height)
    : eye_(camera.eye), width_(width), height_(height) {
    const double halfHeight = std::tan(glm::radians(camera.fovY) / 2);
    forward_ = glm::normalize(camera.target - camera.eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward_, camera.up));
    right_ = halfHeight * right;
    up_ = halfHeight * glm::cross(right, forward_);
}

Ray PixelRays::ray(int x, int y) const {
    const double half = height_ / 2;
    return {eye_, forward_ + right_ * ((x + 0.5 - width_ / 2) / half) + up_ * ((half - (y + 0.5)) / half)};
}

RayCaster::RayCaster(std::vector<Triangle> triangles) : bvh_(buildBvh(triangles)), leaves_(triangles.size()) {
    for (std::size_t i = 0; i < leaves_.size(); ++i) leaves_[i] = triangles[bvh_.order[i]];
}

Hit RayCaster::cast(const Ray& ray, double nearDepth) const {
    if (bvh_.nodes.empty()) return {};
    const ShearedRay sheared(ray);
    const double padding = paddingFor(bvh_.nodes[0].box, ray.origin);
    Hit best{kInfinity, kNoTriangle};

    auto visitLeaf = [&](const Bvh::Node& leaf) {
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
            const std::optional<double> depth = intersect(sheared, leaves_[i]);
            if (!depth || !(*depth > 0) || *depth < nearDepth) continue;
            const Hit hit{*depth, bvh_.order[i]};
            if (std::pair(hit.depth, hit.triangle) < std::pair(best.depth, best.triangle)) best = hit;
        }
    };

    // Depth first, the nearer child first; the farther one waits on the stack, at most one a level.
    struct Waiting {
        double enter;
        std::uint32_t node;
    };
    std::array<Waiting, Bvh::kMaxDepth + 2> stack;
    std::size_t waiting = 0;
    stack[waiting++] = {entry(sheared, bvh_.nodes[0].box, padding, kInfinity), 0};
    while (waiting > 0) {
        const Waiting next = stack[--waiting];
        if (next.enter == kInfinity || next.enter > best.depth) continue;
        const Bvh::Node& node = bvh_.nodes[next.node];
        if (node.count > 0) {
            visitLeaf(node);
            continue;
        }
        Waiting near{entry(sheared, bvh_.nodes[node.first].box, padding, best.depth), node.first};
        Waiting far{entry(sheared, bvh_.nodes[node.first + 1].box, padding, best.depth), node.first + 1};
        if (far.enter < near.enter) std::swap(near, far);
        if (far.enter != kInfinity) stack[waiting++] = far;
        if (near.enter != kInfinity) stack[waiting++] = near;
    }
    return best.triangle == kNoTriangle ? Hit{} : best;
}

CastPicture castPicture(const RayCaster& caster, const Camera& camera, int width, int height,
                        double nearDepth, unsigned threads) {
    const PixelRays rays(camera, width, height);
    CastPicture picture{{width, height, 1}, {width, height, 1}};
    std::atomic<int> nextRow = 0;
    auto castRows = [&] {
        for (int y = nextRow++; y < height; y = nextRow++) {
            for (int x = 0; x < width; ++x) {
                const Hit hit = caster.cast(rays.ray(x, y), nearDepth);
                *picture.depth.at(x, y) = hit.depth;
                *picture.triangle.at(x, y) = hit.triangle;
            }
        }
    };
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::jthread> workers;
    for (unsigned i = 0; i < threads; ++i) workers.emplace_back(castRows);
    workers.clear();  // waits for them
    return picture;
}

}  // namespace iwalk::tools
