#include "preprocess/import/triangle_output.hpp"

#include <cmath>
#include <glm/geometric.hpp>

#include "preprocess/import/vertex_store.hpp"

namespace iwalk {
namespace {

bool isFinite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Of a triangle without area any direction is as good as another.
glm::vec3 faceNormal(const Triangle& t) {
    const glm::vec3 a = unitOrZero(t[1].position - t[0].position),
                    b = unitOrZero(t[2].position - t[0].position);
    const glm::vec3 normal = unitOrZero(glm::cross(glm::dvec3(a), glm::dvec3(b)));
    return normal == glm::vec3(0) ? glm::vec3(0, 0, 1) : normal;
}

void completeNormals(Triangle& t) {
    for (Corner& corner : t) {
        if (corner.normal == glm::vec3(0)) corner.normal = faceNormal(t);
    }
}

}  // namespace

TriangleOutput::TriangleOutput(bool normals, const TriangleSink& sink) : normals_(normals), sink_(sink) {
    batch_.reserve(kBatch);
}

Result<void> TriangleOutput::corner(const Corner& corner) {
    if (corners_ == 2) RETURN_IF_ERROR(add(corner));
    if (corners_ == 0) first_ = corner;
    if (corners_ < 2) ++corners_;
    previous_ = corner;
    return {};
}

Result<void> TriangleOutput::add(const Corner& third) {
    if (!isFinite(first_.position) || !isFinite(previous_.position) || !isFinite(third.position)) {
        ++counts_.droppedNonFinite;
        return {};
    }
    Triangle& triangle = batch_.emplace_back(Triangle{first_, previous_, third});
    if (normals_) completeNormals(triangle);
    ++counts_.triangles;
    return batch_.size() == kBatch ? flush() : Result<void>();
}

Result<void> TriangleOutput::flush() {
    if (batch_.empty()) return {};
    if (sink_) RETURN_IF_ERROR(sink_(batch_));
    batch_.clear();
    return {};
}

}  // namespace iwalk
