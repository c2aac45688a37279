#include "client/window/wall_map.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace iwalk::client {
namespace {

constexpr float kWidth = 13, kMostHeight = 15;  // of the font's size
constexpr float kNameHeight = 3;                // a tile that is less high has no text

// From calm to busy.
ImU32 loadColor(double load) {
    const auto part = static_cast<float>(std::clamp(load, 0.0, 1.0));
    return ImGui::GetColorU32({0.20f + 0.55f * part, 0.48f - 0.12f * part, 0.42f - 0.20f * part, 1});
}

double busyMs(const protocol::TileStats& tile) {
    return tile.visibilityMs + tile.adaptMs + tile.fetchWaitMs + tile.drawMs;
}

void drawTile(const PlaceOnWall& place, const protocol::TileStats& tile, const ImVec2& corner,
              const ImVec2& size, double longest) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const auto at = [&](double x, double y) {
        return ImVec2(corner.x + static_cast<float>(x) * size.x, corner.y + static_cast<float>(y) * size.y);
    };
    const ImVec2 from = at(place.x, place.y), to = at(place.x + place.width, place.y + place.height);
    const double load = longest > 0 ? busyMs(tile) / longest : 0;
    // As high as its share of the slowest tile's time.
    list.AddRectFilled(from, to, IM_COL32(38, 44, 54, 255));
    list.AddRectFilled({from.x, to.y - static_cast<float>(load) * (to.y - from.y)}, to, loadColor(load));
    const bool bad = tile.badPages > 0, stalls = tile.stalls > 0;
    const ImU32 frame = bad      ? IM_COL32(255, 80, 70, 255)
                        : stalls ? IM_COL32(255, 190, 90, 255)
                                 : IM_COL32(12, 14, 18, 255);
    list.AddRect(from, to, frame, 0, 0, bad || stalls ? 3.0f : 1.0f);

    const float line = ImGui::GetFontSize();
    if (to.y - from.y < kNameHeight * line || to.x - from.x < kNameHeight * line) return;
    list.AddText({from.x + 6, from.y + 4}, IM_COL32(235, 240, 245, 255),
                 fmt::format("{:.0f} ms", busyMs(tile)).c_str());
    const std::string wrong = bad      ? fmt::format("bad pages: {}", tile.badPages)
                              : stalls ? fmt::format("stalls: {}", tile.stalls)
                                       : "";
    list.AddText({from.x + 6, from.y + 4 + line}, frame, wrong.c_str());
}

}  // namespace

SmallWall smallWall(const protocol::Welcome& welcome) {
    SmallWall wall;
    if (welcome.wallWidth > 0 && welcome.wallHeight > 0) {
        const double w = welcome.wallWidth, h = welcome.wallHeight;
        for (const protocol::TileInfo& tile : welcome.tiles)
            wall.places.push_back({tile.x / w, tile.y / h, tile.width / w, tile.height / h});
        wall.aspect = w / h;
        return wall;
    }
    const auto count = static_cast<double>(welcome.tiles.size());
    const double columns = std::ceil(std::sqrt(count)), rows = std::ceil(count / columns);
    double aspect = 1;
    for (std::size_t i = 0; i < welcome.tiles.size(); ++i) {
        const auto number = static_cast<double>(i);
        const double row = std::floor(number / columns), column = number - row * columns;
        wall.places.push_back({column / columns, row / rows, 1 / columns, 1 / rows});
        aspect = static_cast<double>(welcome.tiles[0].width) / welcome.tiles[0].height;
    }
    wall.aspect = aspect * columns / rows;
    return wall;
}

void drawWallMap(const protocol::Welcome& welcome, const protocol::FrameDone& frame) {
    const SmallWall wall = smallWall(welcome);
    const float line = ImGui::GetFontSize();
    float width = kWidth * line, height = width / static_cast<float>(wall.aspect);
    if (height > kMostHeight * line) width *= kMostHeight * line / height, height = kMostHeight * line;
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    double longest = 0;
    std::uint64_t bad = 0;
    for (const protocol::TileStats& tile : frame.tiles) {
        longest = std::max(longest, busyMs(tile));
        bad += tile.badPages;
    }
    for (const protocol::TileStats& tile : frame.tiles)
        if (tile.tile < wall.places.size())
            drawTile(wall.places[tile.tile], tile, corner, {width, height}, longest);
    ImGui::Dummy({width, height});
    if (bad > 0)
        ImGui::TextColored({1, 0.45f, 0.40f, 1}, "pages cannot be read");
    else
        ImGui::TextDisabled("load of %zu tiles", welcome.tiles.size());
}

}  // namespace iwalk::client
