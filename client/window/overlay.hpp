#pragma once

#include <vector>

#include "client/fly/flight.hpp"
#include "client/window/picture_wall.hpp"
#include "client/window/settings_panel.hpp"

struct GLFWwindow;

namespace iwalk::client {

// All that the window shows: the wall's preview, and over it status, map, help and settings (Dear ImGui).
class Overlay {
  public:
    // With the window's GL context current, which stays so.
    explicit Overlay(GLFWwindow* window);
    ~Overlay();
    Overlay(const Overlay&) = delete;
    Overlay& operator=(const Overlay&) = delete;

    void takePreviews(std::vector<protocol::TileImage> previews, const WallState& wall);
    void draw(Flight& flight);

    void toggleHelp() { help_ = !help_; }
    void toggleSettings() { settings_ = !settings_; }
    void toggleStatus() { status_ = !status_; }
    void closePanels() { help_ = settings_ = false; }

  private:
    PictureWall pictures_;
    SettingsPanel panel_;
    bool help_ = false, settings_ = false, status_ = true;
};

}  // namespace iwalk::client
