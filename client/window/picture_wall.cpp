#include "client/window/picture_wall.hpp"

#include <epoxy/gl.h>
#include <imgui.h>

#include "client/window/wall_map.hpp"
#include "common/jpeg.hpp"

namespace iwalk::client {
namespace {

constexpr std::size_t kMostPixels = std::size_t{4096} * 4096;  // of the wall: what the setting allows at most

}  // namespace

void PictureWall::clear() {
    for (const auto& [tile, picture] : pictures_) glDeleteTextures(1, &picture.texture);
    pictures_.clear();
    pixels_ = 0;
}

void PictureWall::take(const protocol::TileImage& preview, const WallState& wall) {
    if (of_ != wall.welcome) clear();
    of_ = wall.welcome;
    Picture& picture = pictures_[preview.tile];
    const Result<ColorImage> image = decodeJpeg(preview.bytes, kMostPixels - pixels_ + picture.pixels);
    if (!image) return;
    pixels_ -= picture.pixels;
    picture.pixels = static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height);
    pixels_ += picture.pixels;

    const bool first = picture.texture == 0;
    if (first) glGenTextures(1, &picture.texture);
    glBindTexture(GL_TEXTURE_2D, picture.texture);
    if (first) {
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, image->width, image->height, 0, GL_RGB, GL_UNSIGNED_BYTE,
                 image->pixels.data());
}

void PictureWall::draw(const Flight& flight) {
    const SmallWall wall = smallWall(*flight.wall().welcome);
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    ImVec2 size(window.x, window.x / static_cast<float>(wall.aspect));
    if (size.y > window.y) size = {window.y * static_cast<float>(wall.aspect), window.y};
    const ImVec2 corner((window.x - size.x) / 2, (window.y - size.y) / 2);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (std::uint32_t tile = 0; tile < wall.places.size(); ++tile) {
        const PlaceOnWall& place = wall.places[tile];
        const auto at = [&](double x, double y) {
            return ImVec2(corner.x + static_cast<float>(x) * size.x,
                          corner.y + static_cast<float>(y) * size.y);
        };
        const ImVec2 from = at(place.x, place.y), to = at(place.x + place.width, place.y + place.height);
        const auto picture = pictures_.find(tile);
        if (flight.preview() && picture != pictures_.end() && picture->second.texture != 0 &&
            of_ == flight.wall().welcome) {
            // What a lost server showed last is seen dimmed.
            const ImU32 tint = flight.wall().connected ? IM_COL32_WHITE : IM_COL32(110, 110, 110, 255);
            list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture->second.texture)),
                          from, to, {0, 0}, {1, 1}, tint);
        } else {
            list.AddRectFilled(from, to, IM_COL32(24, 28, 34, 255));
            list.AddRect(from, to, IM_COL32(52, 60, 72, 255));
        }
    }
}

}  // namespace iwalk::client
