#include "server/present/patterns.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "common/canvas.hpp"
#include "common/font.hpp"

namespace iwalk {
namespace {

const Color kBlack(0), kWhite(1), kDim(0.25f), kBright(0.55f), kYellow(1, 0.85f, 0.1f),
    kGreen(0.2f, 0.9f, 0.4f), kBlue(0.35f, 0.65f, 1), kRed(1, 0.3f, 0.25f);
constexpr int kCell = 64, kBold = 256;  // px between lines of the grid

// A tile's canvas, addressed in px of its screen: what is drawn there goes on in the next tile.
class TileCanvas {
  public:
    TileCanvas(const PixelRect& rect, const Color& background)
        : rect_(rect), canvas_(rect.width, rect.height, background) {}

    void rectangle(int x, int y, int width, int height, const Color& color) {
        const int left = std::max(x, rect_.x), right = std::min(x + width, rect_.x + rect_.width);
        const int top = std::max(y, rect_.y), bottom = std::min(y + height, rect_.y + rect_.height);
        canvas_.rectangle(left - rect_.x, top - rect_.y, right - left, bottom - top, color);
    }
    // Its middle is at x; the first line begins at y.
    void text(int x, int y, int scale, const std::string& letters, const Color& color) {
        canvas_.text(x - rect_.x - textWidth(letters) * scale / 2, y - rect_.y, scale, letters, color);
    }
    // Colours the pixels whose centres (px of the screen) `inside` takes.
    template <class Inside>
    void where(const Inside& inside, const Color& color) {
        for (int y = rect_.y; y < rect_.y + rect_.height; ++y)
            for (int x = rect_.x; x < rect_.x + rect_.width; ++x)
                if (inside(glm::dvec2(x + 0.5, y + 0.5))) rectangle(x, y, 1, 1, color);
    }
    void frame(int inset, int thickness, const Color& color) {
        const int width = rect_.width - 2 * inset, height = rect_.height - 2 * inset;
        const int x = rect_.x + inset, y = rect_.y + inset;
        rectangle(x, y, width, thickness, color);
        rectangle(x, y + height - thickness, width, thickness, color);
        rectangle(x, y, thickness, height, color);
        rectangle(x + width - thickness, y, thickness, height, color);
    }
    bool reachedBy(const glm::dvec2& middle, double radius) const {
        const glm::dvec2 low(rect_.x, rect_.y), high(rect_.x + rect_.width, rect_.y + rect_.height);
        return glm::distance(middle, glm::clamp(middle, low, high)) <= radius + 2;
    }
    const PixelRect& rect() const { return rect_; }
    int middleX() const { return rect_.x + rect_.width / 2; }
    int middleY() const { return rect_.y + rect_.height / 2; }
    const ColorImage& image() const { return canvas_.image(); }

  private:
    const PixelRect rect_;
    Canvas canvas_;
};

// As large as fits into `width` px, but not larger than `most`.
int scaleFor(const std::string& text, int width, int most) {
    return std::clamp(width / std::max(1, textWidth(text)), 1, std::max(1, most));
}

// On a wall of one screen: circles about its middle and its diagonals, in px.
void drawAcross(const Screen& screen, TileCanvas& canvas) {
    const glm::dvec2 size(screen.width, screen.height), middle = size / 2.0;
    const double largest = std::min(size.x, size.y) / 2 - 2;
    canvas.where(
        [&](const glm::dvec2& p) {
            const double thirds = 3 * glm::distance(p, middle) / largest, ring = std::round(thirds);
            return ring >= 1 && ring <= 3 && std::abs(thirds - ring) * largest / 3 < 1.5;
        },
        kYellow);
    canvas.where(
        [&](const glm::dvec2& p) {
            const glm::dvec2 q = (p - middle) / size;
            return std::abs(std::abs(q.x) - std::abs(q.y)) * std::min(size.x, size.y) < 1;
        },
        kBlue);
}

// Circles whose middles lie halfway between neighbours: what a bezel hides of them shows whether it is
// measured right.
void drawAtBorders(const Wall& wall, const Tile& tile, TileCanvas& canvas) {
    for (const Tile& other : wall.tiles) {
        if (other.screen != tile.screen) continue;
        const PixelRect& from = other.onScreen;
        const auto isNext = [&](const PixelRect& to, bool across) {
            const int along = across ? to.x - from.x : to.y - from.y;
            return along > 0 && along < 2 * (across ? from.width : from.height) &&
                   (across ? to.y == from.y : to.x == from.x);
        };
        for (const bool across : {true, false}) {
            const auto next = std::find_if(wall.tiles.begin(), wall.tiles.end(), [&](const Tile& t) {
                return t.screen == tile.screen && isNext(t.onScreen, across);
            });
            if (next == wall.tiles.end()) continue;
            const PixelRect& to = next->onScreen;
            const glm::dvec2 middle((from.x + to.x + from.width) / 2.0, (from.y + to.y + from.height) / 2.0);
            const double radius = std::min(from.width, from.height) / 4.0;
            canvas.where(
                [&](const glm::dvec2& p) { return std::abs(glm::distance(p, middle) - radius) < 1.5; },
                kGreen);
        }
    }
}

// Around the eye of free screens: what is straight or round to it goes on across the corners of the room.
// Every 15 degrees a cone about the view, the horizon, and the plane of the middle.
void drawAround(const Screen& screen, TileCanvas& canvas) {
    const glm::dvec3 right = (screen.topRight - screen.topLeft) / double(screen.width);
    const glm::dvec3 down = (screen.bottomLeft - screen.topLeft) / double(screen.height);
    const double pixel = std::max(glm::length(right), glm::length(down));
    const auto at = [&](const glm::dvec2& p) { return screen.topLeft + p.x * right + p.y * down; };
    canvas.where(
        [&](const glm::dvec2& p) {
            const glm::dvec3 v = at(p);
            const double degrees = std::acos(-v.z / glm::length(v)) * 180 / std::numbers::pi;
            const double off = degrees - 15 * std::round(degrees / 15);
            return std::abs(off) * std::numbers::pi / 180 * glm::length(v) < 1.5 * pixel;
        },
        kYellow);
    canvas.where(
        [&](const glm::dvec2& p) {
            const glm::dvec3 v = at(p);
            return std::min(std::abs(v.x), std::abs(v.y)) < 1.5 * pixel;
        },
        kBlue);
}

// Single pixels: a chessboard and pairs of lines show whether the display scales them.
void drawPixels(int x, int y, TileCanvas& canvas) {
    constexpr int kSide = 64;
    canvas.rectangle(x - 2 * kSide, y, 4 * kSide, kSide, kBlack);
    for (int row = 0; row < kSide; ++row) {
        for (int column = 0; column < kSide; ++column)
            if ((row + column) % 2 == 0) canvas.rectangle(x - 2 * kSide + column, y + row, 1, 1, kWhite);
        if (row % 2 == 0) canvas.rectangle(x - kSide + 16, y + row, kSide - 16, 1, kWhite);
        if (row % 2 == 0) canvas.rectangle(x + 16 + row, y, 1, kSide, kWhite);
    }
    for (int step = 0; step < 8; ++step)
        canvas.rectangle(x + kSide + 32 + 4 * step, y, 4, kSide, Color(static_cast<float>(step) / 7));
}

void drawGrid(const Wall& wall, const Tile& tile, TileCanvas& canvas) {
    const Screen screen = wall.screens(60)[tile.screen];
    for (const int step : {kCell, kBold}) {
        const Color& color = step == kCell ? kDim : kBright;
        for (int x = 0; x < screen.width; x += step) canvas.rectangle(x, 0, 1, screen.height, color);
        for (int y = 0; y < screen.height; y += step) canvas.rectangle(0, y, screen.width, 1, color);
    }
    if (wall.freeScreens.empty())
        drawAcross(screen, canvas);
    else
        drawAround(screen, canvas);
    drawAtBorders(wall, tile, canvas);
    canvas.frame(0, 1, kWhite);
    canvas.frame(2, 1, kRed);
    const int x = canvas.middleX(), y = canvas.middleY();
    const int scale = scaleFor(tile.name, canvas.rect().width / 3, 6);
    canvas.rectangle(x - textWidth(tile.name) * scale / 2 - 8, y - 7 * scale - 20,
                     textWidth(tile.name) * scale + 16, 7 * scale + 12, kBlack);
    canvas.text(x, y - 7 * scale - 14, scale, tile.name, kWhite);
    drawPixels(x, y + 8, canvas);
}

void drawBlend(const Tile& tile, int wallHeight, TileCanvas& canvas) {
    constexpr float kValues[] = {1.0f, 0.75f, 0.5f, 0.25f, 0.1f, 0.0f};
    constexpr int kBands = 6;
    for (int band = 0; band < kBands; ++band) {
        const int top = wallHeight * band / kBands, bottom = wallHeight * (band + 1) / kBands;
        canvas.rectangle(canvas.rect().x, top, canvas.rect().width, bottom - top, Color(kValues[band]));
    }
    // In the black band, where ramps begin and end; neighbours draw the same lines.
    const auto [x, y, width, height] = tile.onScreen;
    const int top = wallHeight * (kBands - 1) / kBands;
    if (tile.blend.left > 0) {
        canvas.rectangle(x, top, 1, height, kGreen);
        canvas.rectangle(x + tile.blend.left - 1, top, 1, height, kRed);
    }
    if (tile.blend.right > 0) {
        canvas.rectangle(x + width - tile.blend.right, top, 1, height, kGreen);
        canvas.rectangle(x + width - 1, top, 1, height, kRed);
    }
    canvas.text(canvas.middleX(), std::min(y + height, wallHeight) - 24, 2, tile.name, kWhite);
}

void drawIdentity(const Wall& wall, std::size_t number, const DrawnBy& by, TileCanvas& canvas) {
    const Tile& tile = wall.tiles[number];
    const PixelRect& rect = canvas.rect();
    const Color colors[] = {
        {0.16f, 0.32f, 0.55f}, {0.5f, 0.24f, 0.2f}, {0.18f, 0.42f, 0.24f}, {0.42f, 0.34f, 0.12f}};
    const int column = rect.x / std::max(1, rect.width), row = rect.y / std::max(1, rect.height);
    canvas.rectangle(rect.x, rect.y, rect.width, rect.height,
                     colors[(column + 2 * row + static_cast<int>(tile.screen)) % 4]);
    canvas.frame(0, 1, kWhite);
    // An arrow up.
    const int x = canvas.middleX(), arrow = std::min(rect.width, rect.height) / 12;
    for (int i = 0; i < arrow; ++i) canvas.rectangle(x - i, rect.y + 8 + i, 2 * i + 1, 1, kWhite);

    const int width = rect.width * 9 / 10, unit = std::max(1, rect.height / 160);
    int y = rect.y + rect.height / 5;
    const auto line = [&](const std::string& text, int most, const Color& color) {
        const int scale = scaleFor(text, width, most);
        canvas.text(x, y, scale, text, color);
        y += (kLetterHeight + 3) * scale;
    };
    line(tile.name, 6 * unit, kWhite);
    line(fmt::format("rank {} of {}", by.rank, by.ranks), 3 * unit, kYellow);
    line(fmt::format("on {}", by.host), 2 * unit, kWhite);
    line(fmt::format("{} x {} px", rect.width, rect.height), 2 * unit, kWhite);
    if (!tile.display.empty()) line(fmt::format("display {}", tile.display), 2 * unit, kWhite);
    if (!tile.monitor.empty()) line(fmt::format("monitor {}", tile.monitor), 2 * unit, kWhite);
}

}  // namespace

ColorImage drawPattern(Pattern pattern, const Wall& wall, std::size_t tile, const DrawnBy& by) {
    TileCanvas canvas(wall.tiles[tile].onScreen, kBlack);
    if (pattern == Pattern::grid) drawGrid(wall, wall.tiles[tile], canvas);
    if (pattern == Pattern::blend)
        drawBlend(wall.tiles[tile], wall.screens(60)[wall.tiles[tile].screen].height, canvas);
    if (pattern == Pattern::identity) drawIdentity(wall, tile, by, canvas);
    return canvas.image();
}

}  // namespace iwalk
