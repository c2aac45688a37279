#include "client/window/settings_panel.hpp"

#include <imgui.h>
#include <imgui_stdlib.h>

#include "common/settings.hpp"

namespace iwalk::client {
namespace {

constexpr float kFieldWidth = 11;  // of the font's size
constexpr float kHelpWidth = 30;

void explain(const SettingInfo& info) {
    if (!ImGui::IsItemHovered()) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(kHelpWidth * ImGui::GetFontSize());
    ImGui::TextUnformatted(info.help);
    if (!info.live) ImGui::TextDisabled("Only when the servers start.");
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

}  // namespace

void SettingsPanel::draw(Flight& flight) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({size.x - 16, size.y - 16}, ImGuiCond_Always, {1, 1});
    constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                                        ImGuiWindowFlags_AlwaysAutoResize |
                                        ImGuiWindowFlags_NoFocusOnAppearing;
    ImGui::Begin("Settings of the servers", nullptr, kFlags);
    if (ImGui::BeginTable("settings", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const SettingInfo& info : settingTable()) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::AlignTextToFramePadding();
            ImGui::TextUnformatted(info.name);
            explain(info);
            ImGui::TableNextColumn();
            ImGui::SetNextItemWidth(kFieldWidth * ImGui::GetFontSize());
            const std::string value = flight.value(info.name);
            if (info.live && flight.steers())
                drawRow(flight, info.name, info.form, value);
            else
                ImGui::TextDisabled("%s", value.c_str());
            explain(info);
        }
        ImGui::EndTable();
    }
    if (!flight.wall().refusal.empty()) {
        ImGui::PushTextWrapPos(kHelpWidth * ImGui::GetFontSize());
        ImGui::TextColored({1, 0.55f, 0.45f, 1}, "%s", flight.wall().refusal.c_str());
        ImGui::PopTextWrapPos();
    }
    ImGui::End();
}

void SettingsPanel::drawRow(Flight& flight, const char* name, const std::string& form,
                            const std::string& value) {
    ImGui::PushID(name);
    if (const std::vector<std::string> choices = choicesOf(form); !choices.empty()) {
        if (ImGui::BeginCombo("##choice", value.c_str())) {
            for (const std::string& choice : choices)
                if (ImGui::Selectable(choice.c_str(), choice == value)) flight.change(name, choice);
            ImGui::EndCombo();
        }
    } else {
        // What is typed counts when it is finished; until then the server's word does not overwrite it.
        std::string& text = typed_.try_emplace(name, value).first->second;
        const bool entered =
            ImGui::InputTextWithHint("##text", form.c_str(), &text, ImGuiInputTextFlags_EnterReturnsTrue);
        if (entered || ImGui::IsItemDeactivatedAfterEdit()) {
            if (text != value) flight.change(name, text);
        } else if (!ImGui::IsItemActive()) {
            text = value;
        }
    }
    ImGui::PopID();
}

}  // namespace iwalk::client
