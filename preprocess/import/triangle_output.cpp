#include "preprocess/import/triangle_output.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "preprocess/import/vertex_output.hpp"
#include "preprocess/import/vertex_store.hpp"

namespace iwalk {
namespace {

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

TriangleOutput::TriangleOutput(bool normals, const TriangleSink& sink) : normals_(normals), sink_(sink) {}

Result<void> TriangleOutput::corner(const Corner& corner) {
    if (corners_ == 2) {
        next() = {first_, previous_, corner};
        RETURN_IF_ERROR(add());
    }
    if (corners_ == 0) first_ = corner;
    if (corners_ < 2) ++corners_;
    previous_ = corner;
    return {};
}

Result<void> TriangleOutput::add() {
    Triangle& t = next();
    if (!isFinite(t[0].position) || !isFinite(t[1].position) || !isFinite(t[2].position)) {
        ++counts_.droppedNonFinite;
        return {};
    }
    if (normals_) completeNormals(t);
    ++counts_.triangles;
    return ++size_ == kBatch ? flush() : Result<void>();
}

Result<void> TriangleOutput::flush() {
    batch_.resize(std::exchange(size_, 0));
    Result<void> taken = sink_ && !batch_.empty() ? sink_(batch_) : Result<void>();
    batch_.resize(kBatch);
    return taken;
}

}  // namespace iwalk
