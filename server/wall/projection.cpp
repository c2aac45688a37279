#include "server/wall/projection.hpp"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace iwalk {

ScreenProjection projectScreen(const Screen& screen, const Camera& camera) {
    const glm::dvec3 back = glm::normalize(camera.eye - camera.target);
    const glm::dvec3 right = glm::normalize(glm::cross(camera.up, back));
    const glm::dmat3 toModel(right, glm::cross(back, right), back);

    // A place on the screen is topLeft + x * perPixelX + y * perPixelY: a 3x3 matrix of (x, y, 1).
    const glm::dvec3 perPixelX = toModel * (screen.topRight - screen.topLeft) / double(screen.width);
    const glm::dvec3 perPixelY = toModel * (screen.bottomLeft - screen.topLeft) / double(screen.height);
    const glm::dvec3 topLeft = toModel * screen.topLeft;

    // Scaled so that every such place has distance 1 along the normal.
    const glm::dvec3 normal = glm::normalize(glm::cross(perPixelX, perPixelY));
    const double distance = glm::dot(normal, topLeft);
    ScreenProjection projection;
    projection.toDirection = glm::dmat3(perPixelX, perPixelY, topLeft) / distance;
    projection.toPixels = glm::inverse(projection.toDirection);
    return projection;
}

Frustum frustumOf(const ScreenProjection& projection, const PixelRect& rect, double margin, double near) {
    const glm::dmat3 rows = glm::transpose(projection.toPixels);
    const double left = rect.x - margin, right = rect.x + rect.width + margin;
    const double top = rect.y - margin, bottom = rect.y + rect.height + margin;
    Frustum frustum;
    frustum.planes[0] = rows[0] - left * rows[2];
    frustum.planes[1] = right * rows[2] - rows[0];
    frustum.planes[2] = rows[1] - top * rows[2];
    frustum.planes[3] = bottom * rows[2] - rows[1];
    frustum.forward = rows[2];
    frustum.near = near;
    return frustum;
}

}  // namespace iwalk
