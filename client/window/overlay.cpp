#include "client/window/overlay.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <filesystem>

#include "client/window/help_panel.hpp"
#include "client/window/status_panel.hpp"

namespace iwalk::client {
namespace {

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr float kFontPx = 15;

void choosePalette() {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 6;
    style.FrameRounding = 4;
    style.WindowBorderSize = 0;
    style.WindowPadding = {14, 12};
    style.ItemSpacing = {10, 6};
    style.CellPadding = {6, 3};
    ImVec4* colors = style.Colors;
    colors[ImGuiCol_WindowBg] = {0.06f, 0.07f, 0.09f, 0.86f};
    colors[ImGuiCol_TitleBg] = colors[ImGuiCol_TitleBgActive] = {0.10f, 0.12f, 0.16f, 0.95f};
    colors[ImGuiCol_FrameBg] = {0.16f, 0.19f, 0.24f, 1};
    colors[ImGuiCol_FrameBgHovered] = {0.22f, 0.27f, 0.34f, 1};
    colors[ImGuiCol_Header] = colors[ImGuiCol_Button] = {0.20f, 0.33f, 0.50f, 1};
    colors[ImGuiCol_Text] = {0.92f, 0.94f, 0.96f, 1};
    colors[ImGuiCol_TextDisabled] = {0.58f, 0.63f, 0.69f, 1};
}

}  // namespace

Overlay::Overlay(GLFWwindow* window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // windows are where they are; no file is left behind
    choosePalette();
    float scale = 1, ignored = 1;
    glfwGetWindowContentScale(window, &scale, &ignored);
    ImGui::GetStyle().ScaleAllSizes(scale);
    std::error_code error;
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    if (std::filesystem::exists(kFont, error))
        fonts.AddFontFromFileTTF(kFont, kFontPx * scale);
    else
        fonts.AddFontDefault();
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
}

Overlay::~Overlay() {
    pictures_.clear();
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Overlay::takePreviews(std::vector<protocol::TileImage> previews, const WallState& wall) {
    for (const protocol::TileImage& preview : previews) pictures_.take(preview, wall);
}

void Overlay::draw(Flight& flight) {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    if (flight.wall().welcome) pictures_.draw(flight);
    if (status_) drawStatus(flight);
    drawNote(flight);
    if (help_) drawHelp();
    if (settings_) panel_.draw(flight);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace iwalk::client
