#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <limits>
#include <string_view>
#include <vector>

#include "common/image.hpp"

namespace iwalk {

using Color = glm::vec3;  // sRGB, [0, 1]

// A picture of triangles with lines over them, drawn on the CPU. Points are (x, y, z): px from the top left,
// and the distance from the viewer, less being nearer.
class Canvas {
  public:
    Canvas(int width, int height, const Color& background);

    // Triangles that cover no pixel's centre leave one pixel.
    void triangle(const std::array<glm::dvec3, 3>& corners, const Color& color);
    // Shows where no triangle is nearer by more than `slack`. After all triangles; of lines at one place the
    // nearest shows, and of those as near the last.
    void line(const glm::dvec3& from, const glm::dvec3& to, const Color& color, double slack);
    // A filled rectangle over everything; and text, 7 `scale` px high (common/font.hpp).
    void rectangle(int x, int y, int width, int height, const Color& color);
    void text(int x, int y, int scale, std::string_view letters, const Color& color);

    const ColorImage& image() const { return image_; }

  private:
    std::size_t place(int x, int y) const;
    bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < image_.width && y < image_.height; }
    void surface(int x, int y, double z, const Color& color);
    void put(int x, int y, const Color& color);

    ColorImage image_;
    std::vector<float> surfaces_, lines_;  // distance of the nearest
};

}  // namespace iwalk
