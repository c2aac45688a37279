#include "server/wall/wall_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>

#include "common/canvas.hpp"
#include "common/font.hpp"
#include "common/geometry.hpp"

namespace iwalk {
namespace {

const Color kPaper(0.11f, 0.12f, 0.14f), kBlack(0), kWhite(1), kGrey(0.6f), kYellow(1, 0.85f, 0.2f);
const Color kHostColors[] = {{0.17f, 0.36f, 0.58f}, {0.52f, 0.26f, 0.22f}, {0.2f, 0.45f, 0.27f},
                             {0.47f, 0.38f, 0.14f}, {0.4f, 0.25f, 0.5f},   {0.16f, 0.44f, 0.46f}};
constexpr int kMargin = 50;  // px

std::vector<Color> colorsByHost(const Wall& wall) {
    std::map<std::string, std::size_t> hosts;
    std::vector<Color> colors;
    for (const Tile& tile : wall.tiles)
        colors.push_back(
            kHostColors[hosts.emplace(tile.host, hosts.size()).first->second % std::size(kHostColors)]);
    return colors;
}

std::string placeText(const Tile& tile) {
    std::string text = tile.display.empty() ? "" : fmt::format("display {}", tile.display);
    const auto add = [&](const std::string& more) {
        text += fmt::format("{}{}", text.empty() ? "" : " ", more);
    };
    if (!tile.monitor.empty()) add(fmt::format("monitor {}", tile.monitor));
    if (tile.window) add(fmt::format("window {},{}", tile.window->x, tile.window->y));
    return text;
}

// Lines of text with their middle at (x, y), as large as fits into `width` px.
void label(Canvas& canvas, int x, int y, int width, const std::vector<std::string>& lines,
           const Color& color) {
    int longest = 1;
    for (const std::string& line : lines) longest = std::max(longest, textWidth(line));
    const int scale = std::clamp(width / longest, 1, 3), step = (kLetterHeight + 3) * scale;
    y -= step * static_cast<int>(lines.size()) / 2;
    for (const std::string& line : lines) {
        canvas.text(x - textWidth(line) * scale / 2, y, scale, line, color);
        y += step;
    }
}

std::vector<std::string> linesOf(const Wall& wall, std::size_t number) {
    const Tile& tile = wall.tiles[number];
    std::vector<std::string> lines{tile.name, fmt::format("rank {}", number),
                                   fmt::format("{} x {} px", tile.onWall.width, tile.onWall.height)};
    if (!tile.host.empty()) lines.push_back(fmt::format("on {}", tile.host));
    if (const std::string place = placeText(tile); !place.empty()) lines.push_back(place);
    return lines;
}

class FlatPicture {
  public:
    FlatPicture(const Wall& wall, Canvas& canvas)
        : wall_(wall),
          canvas_(canvas),
          scale_(std::min((canvas.image().width - 2 * kMargin) / (wall.width * wall.pixelAspect),
                          double(canvas.image().height - 2 * kMargin) / wall.height)) {}

    void draw() {
        fill({0, 0, wall_.width, wall_.height}, kBlack);
        const std::vector<Color> colors = colorsByHost(wall_);
        for (std::size_t i = 0; i < wall_.tiles.size(); ++i) fill(wall_.tiles[i].onWall, colors[i]);
        for (std::size_t i = 0; i < wall_.tiles.size(); ++i) {
            const auto& [x, y, width, height] = wall_.tiles[i].onWall;
            const Blend& blend = wall_.tiles[i].blend;
            const Color bright = glm::mix(colors[i], kWhite, 0.35f);
            fill({x, y, blend.left, height}, bright);
            fill({x + width - blend.right, y, blend.right, height}, bright);
            fill({x, y, width, blend.top}, bright);
            fill({x, y + height - blend.bottom, width, blend.bottom}, bright);
        }
        for (std::size_t i = 0; i < wall_.tiles.size(); ++i) drawTile(i);
    }

  private:
    glm::ivec2 at(int x, int y) const {
        const double top = (canvas_.image().height - wall_.height * scale_) / 2;
        return {kMargin + std::lround(x * scale_ * wall_.pixelAspect), std::lround(top + y * scale_)};
    }
    void fill(const PixelRect& rect, const Color& color) {
        const glm::ivec2 from = at(rect.x, rect.y), to = at(rect.x + rect.width, rect.y + rect.height);
        canvas_.rectangle(from.x, from.y, to.x - from.x, to.y - from.y, color);
    }
    void drawTile(std::size_t number) {
        const PixelRect& rect = wall_.tiles[number].onWall;
        const glm::ivec2 from = at(rect.x, rect.y), to = at(rect.x + rect.width, rect.y + rect.height);
        const glm::ivec2 size = to - from;
        canvas_.rectangle(from.x, from.y, size.x, 1, kWhite);
        canvas_.rectangle(from.x, to.y - 1, size.x, 1, kWhite);
        canvas_.rectangle(from.x, from.y, 1, size.y, kWhite);
        canvas_.rectangle(to.x - 1, from.y, 1, size.y, kWhite);
        label(canvas_, from.x + size.x / 2, from.y + size.y / 2, size.x * 9 / 10, linesOf(wall_, number),
              kWhite);
    }

    const Wall& wall_;
    Canvas& canvas_;
    const double scale_;
};

// In perspective, from behind the eye and above it.
class RoomPicture {
  public:
    RoomPicture(const Wall& wall, Canvas& canvas) : wall_(wall), canvas_(canvas) {
        Box<double> box;
        box.add(glm::dvec3(0));
        for (const Screen& screen : wall.freeScreens)
            for (int corner = 0; corner < 4; ++corner) box.add(cornerOf(screen, corner & 1, corner >> 1));
        const glm::dvec3 middle = (box.min + box.max) / 2.0;
        radius_ = glm::length(box.max - box.min) / 2;
        from_ = middle + radius_ * glm::dvec3(0.12, 1.6, 2.4);
        back_ = glm::normalize(from_ - middle);
        right_ = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back_));
        up_ = glm::cross(back_, right_);
        focus_ = 1.5 * std::min(canvas.image().width, canvas.image().height);
    }

    void draw() {
        const std::vector<Color> colors = colorsByHost(wall_);
        for (std::size_t i = 0; i < wall_.tiles.size(); ++i) {
            std::array<glm::dvec3, 4> p;
            for (int corner = 0; corner < 4; ++corner)
                p[static_cast<std::size_t>(corner)] =
                    shown(tileCorner(wall_.tiles[i], corner & 1, corner >> 1));
            const Color color =
                glm::mix(colors[i], kWhite, 0.12f * static_cast<float>(wall_.tiles[i].screen % 4));
            canvas_.triangle({p[0], p[1], p[2]}, color);
            canvas_.triangle({p[1], p[3], p[2]}, color);
        }
        for (std::size_t i = 0; i < wall_.tiles.size(); ++i) drawTile(i);
        drawEye();
    }

  private:
    static glm::dvec3 cornerOf(const Screen& screen, double x, double y) {
        return screen.topLeft + x * (screen.topRight - screen.topLeft) +
               y * (screen.bottomLeft - screen.topLeft);
    }
    // x and y: 0 left and top, 1 right and bottom.
    glm::dvec3 tileCorner(const Tile& tile, double x, double y) const {
        const Screen& screen = wall_.freeScreens[tile.screen];
        return cornerOf(screen, (tile.onScreen.x + x * tile.onScreen.width) / screen.width,
                        (tile.onScreen.y + y * tile.onScreen.height) / screen.height);
    }
    glm::dvec3 shown(const glm::dvec3& p) const {
        const glm::dvec3 v = p - from_;
        const double distance = -glm::dot(v, back_);
        return {canvas_.image().width / 2.0 + focus_ * glm::dot(v, right_) / distance,
                canvas_.image().height / 2.0 - focus_ * glm::dot(v, up_) / distance, distance};
    }
    void drawTile(std::size_t number) {
        const Tile& tile = wall_.tiles[number];
        const glm::dvec2 around[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
        for (int i = 0; i < 4; ++i)
            canvas_.line(shown(tileCorner(tile, around[i].x, around[i].y)),
                         shown(tileCorner(tile, around[i + 1].x, around[i + 1].y)), kWhite, 0.01 * radius_);
        const glm::dvec3 middle = shown(tileCorner(tile, 0.5, 0.5)),
                         top = shown(tileCorner(tile, 0.04, 0.04));
        const double width = std::abs(shown(tileCorner(tile, 0, 0.5)).x - shown(tileCorner(tile, 1, 0.5)).x);
        label(canvas_, int(middle.x), int(middle.y), int(width * 0.8), linesOf(wall_, number), kWhite);
        label(canvas_, int(top.x), int(top.y), 1, {"top left"}, kYellow);
    }
    void drawEye() {
        const glm::dvec3 eye = shown(glm::dvec3(0)), ahead = shown(glm::dvec3(0, 0, -0.4 * radius_));
        canvas_.line(eye, ahead, kYellow, 1e9);
        canvas_.rectangle(int(eye.x) - 4, int(eye.y) - 4, 9, 9, kYellow);
        label(canvas_, int(eye.x), int(eye.y) + 18, 1000, {"eye"}, kYellow);
    }

    const Wall& wall_;
    Canvas& canvas_;
    double radius_ = 1, focus_ = 1;
    glm::dvec3 from_, back_, right_, up_;
};

std::string describeScreen(const Screen& screen) {
    const double width = glm::distance(screen.topLeft, screen.topRight),
                 height = glm::distance(screen.topLeft, screen.bottomLeft);
    const glm::dvec3 left = screen.topLeft + (screen.bottomLeft - screen.topLeft) / 2.0;
    const glm::dvec3 right = left + (screen.topRight - screen.topLeft);
    const double angle = std::acos(glm::dot(glm::normalize(left), glm::normalize(right)));
    return fmt::format("{:.3f} x {:.3f} m, pixels of {:.3f} x {:.3f} mm, {:.1f} degrees wide for the eye",
                       width, height, 1000 * width / screen.width, 1000 * height / screen.height,
                       angle * 180 / std::numbers::pi);
}

}  // namespace

ColorImage drawWall(const Wall& wall, int width, int height) {
    Canvas canvas(width, height, kPaper);
    if (wall.freeScreens.empty())
        FlatPicture(wall, canvas).draw();
    else
        RoomPicture(wall, canvas).draw();
    const std::string title = wall.freeScreens.empty() ? fmt::format("{} x {} px", wall.width, wall.height)
                                                       : fmt::format("{} screens", wall.freeScreens.size());
    canvas.text(kMargin, 16, 2, fmt::format("{}, {} tiles", title, wall.tiles.size()), kGrey);
    return canvas.image();
}

std::string describeWall(const Wall& wall) {
    std::string text =
        wall.freeScreens.empty()
            ? fmt::format("a wall of {} x {} px, {} tiles\n", wall.width, wall.height, wall.tiles.size())
            : fmt::format("{} free screens, {} tiles\n", wall.freeScreens.size(), wall.tiles.size());
    for (std::size_t i = 0; i < wall.tiles.size(); ++i) {
        const Tile& tile = wall.tiles[i];
        if (!wall.freeScreens.empty() && (i == 0 || wall.tiles[i - 1].screen != tile.screen))
            text +=
                fmt::format("screen {}: {}\n", tile.screen, describeScreen(wall.freeScreens[tile.screen]));
        const std::string place = placeText(tile);
        text += fmt::format("rank {}: {}, {} x {} px at {},{} of its screen{}{}{}{}\n", i, tile.name,
                            tile.onScreen.width, tile.onScreen.height, tile.onScreen.x, tile.onScreen.y,
                            tile.host.empty() ? "" : ", on ", tile.host, place.empty() ? "" : ", ", place);
    }
    return text;
}

}  // namespace iwalk
