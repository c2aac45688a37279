#include "common/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "common/font.hpp"

namespace iwalk {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

// Twice the signed area of a, b and the point (x, y).
double area(const glm::dvec3& a, const glm::dvec3& b, double x, double y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

int pixel(double at) {
    return static_cast<int>(std::floor(std::clamp(at, -1e6, 1e6)));
}

}  // namespace

Canvas::Canvas(int width, int height, const Color& background) : image_(width, height, 3) {
    surfaces_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kNothing);
    lines_ = surfaces_;
    rectangle(0, 0, width, height, background);
}

std::size_t Canvas::place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x);
}

void Canvas::put(int x, int y, const Color& color) {
    for (std::size_t c = 0; c < 3; ++c) {
        image_.at(x, y)[c] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(color[c], 0.0f, 1.0f)));
    }
}

void Canvas::surface(int x, int y, double z, const Color& color) {
    float& nearest = surfaces_[place(x, y)];
    if (static_cast<float>(z) >= nearest) return;
    nearest = static_cast<float>(z);
    put(x, y, color);
}

void Canvas::triangle(const std::array<glm::dvec3, 3>& corners, const Color& color) {
    const auto& [a, b, c] = corners;
    const glm::dvec3 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
    const double whole = area(a, b, c.x, c.y);
    bool covers = false;
    // Pixels whose centres lie in the box.
    const int left = std::max(0, pixel(low.x + 0.5)), right = std::min(image_.width, pixel(high.x + 0.5));
    const int top = std::max(0, pixel(low.y + 0.5)), bottom = std::min(image_.height, pixel(high.y + 0.5));
    for (int y = top; whole != 0 && y < bottom; ++y) {
        for (int x = left; x < right; ++x) {
            const double u = area(b, c, x + 0.5, y + 0.5) / whole, v = area(c, a, x + 0.5, y + 0.5) / whole;
            if (u < 0 || v < 0 || u + v > 1) continue;
            surface(x, y, u * a.z + v * b.z + (1 - u - v) * c.z, color);
            covers = true;
        }
    }
    const glm::dvec3 middle = (a + b + c) / 3.0;
    const int x = pixel(middle.x), y = pixel(middle.y);
    if (!covers && inside(x, y)) surface(x, y, middle.z, color);
}

void Canvas::line(const glm::dvec3& from, const glm::dvec3& to, const Color& color, double slack) {
    constexpr float kOpacity = 0.8f;
    const glm::dvec3 way = to - from;
    const int steps = std::max(1, pixel(std::max(std::abs(way.x), std::abs(way.y))) + 1);
    for (int i = 0; i <= steps; ++i) {
        const glm::dvec3 p = from + way * (static_cast<double>(i) / steps);
        const int x = pixel(p.x), y = pixel(p.y);
        if (!inside(x, y)) continue;
        float& nearest = lines_[place(x, y)];
        const float z = static_cast<float>(p.z), hidden = surfaces_[place(x, y)] + static_cast<float>(slack);
        if (z > hidden || z > nearest) continue;
        const std::uint8_t* below = image_.at(x, y);
        const Color under = Color(below[0], below[1], below[2]) / 255.0f;
        put(x, y, nearest == kNothing ? glm::mix(under, color, kOpacity) : color);
        nearest = z;
    }
}

void Canvas::rectangle(int x, int y, int width, int height, const Color& color) {
    for (int row = y; row < y + height; ++row) {
        for (int column = x; column < x + width; ++column) {
            if (inside(column, row)) put(column, row, color);
        }
    }
}

void Canvas::text(int x, int y, int scale, std::string_view letters, const Color& color) {
    for (const char letter : letters) {
        for (int row = 0; row < kLetterHeight; ++row) {
            for (int column = 0; column < kLetterWidth; ++column) {
                if (!letterPixel(letter, column, row)) continue;
                rectangle(x + column * scale, y + row * scale, scale, scale, color);
            }
        }
        x += kLetterStep * scale;
    }
}

}  // namespace iwalk
