#include "client/window/help_panel.hpp"

#include <imgui.h>

namespace iwalk::client {
namespace {

struct Row {
    const char *keys, *what;  // without keys: a heading
};
constexpr Row kRows[] = {
    {nullptr, "Moving"},
    {"W A S D", "forward, left, back, right"},
    {"E  Q", "up, down"},
    {"Shift", "four times as fast"},
    {"left mouse", "look around"},
    {"right mouse", "orbit about what is ahead"},
    {"wheel", "faster, slower; near surfaces slow down by themselves"},
    {"G", "walk (the height stays) or fly"},
    {nullptr, "Views and flights"},
    {"Home", "all of the model"},
    {"1 ... 9  0", "a saved view"},
    {"Ctrl + digit", "save the view"},
    {"R", "begin or end recording"},
    {"P", "play the recording"},
    {nullptr, "The wall"},
    {"Tab", "settings of the servers"},
    {"M", "next mode"},
    {"N", "show levels, ranges, ... in colours"},
    {"V", "preview on or off"},
    {"C", "hand control over, or ask for it"},
    {"O", "status and map on or off"},
    {"H  F1", "this help"},
    {"Ctrl + Q", "leave; the wall stays as it is"},
};

}  // namespace

void drawHelp() {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                        ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;
    ImGui::Begin("Keys", nullptr, kFlags);
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const Row& row : kRows) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            if (!row.keys) {
                ImGui::TextDisabled("%s", row.what);
                continue;
            }
            ImGui::TextColored({0.55f, 0.80f, 1, 1}, "%s", row.keys);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(row.what);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace iwalk::client
