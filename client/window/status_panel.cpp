#include "client/window/status_panel.hpp"

#include <imgui.h>

#include <algorithm>

#include "client/window/wall_map.hpp"

namespace iwalk::client {
namespace {

const ImVec4 kGood{0.45f, 0.85f, 0.50f, 1}, kAttention{1, 0.75f, 0.35f, 1}, kBad{1, 0.45f, 0.40f, 1};
constexpr double kNoteSeconds = 4;
constexpr ImGuiWindowFlags kPanel = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                    ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoInputs |
                                    ImGuiWindowFlags_NoFocusOnAppearing;

std::string count(double value) {
    if (value < 1e4) return fmt::format("{:.0f}", value);
    if (value < 1e7) return fmt::format("{:.0f} thousand", value / 1e3);
    return fmt::format("{:.1f} million", value / 1e6);
}

void row(const char* name, const std::string& value) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", name);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(value.c_str());
}

void drawConnection(const Flight& flight) {
    const WallState& wall = flight.wall();
    if (!wall.connected) {
        ImGui::TextColored(kBad, wall.welcome ? "server lost" : "no server yet");
    } else if (!wall.told) {
        ImGui::TextColored(kAttention, "connecting");
    } else if (!wall.control) {
        ImGui::TextColored(kAttention, "watching: another client steers");
    } else if (wall.waiting > 0) {
        ImGui::TextColored(kAttention, "you steer; %u want to: C hands over", wall.waiting);
    } else {
        ImGui::TextColored(kGood, "you steer");
    }
    if (flight.recording()) ImGui::TextColored(kBad, "recording, frames: %zu", flight.recorded());
    if (flight.replaying()) ImGui::TextColored(kGood, "replaying");
}

void drawFrame(const WallState& wall) {
    double triangles = 0, error = 0, barrier = 0;
    for (const protocol::TileStats& tile : wall.frame->tiles) {
        triangles += static_cast<double>(tile.triangles);
        error = std::max(error, tile.screenErrorPx);
        barrier = std::max(barrier, tile.barrierWaitMs);
    }
    row("frames a second",
        wall.framesPerSecond > 0 ? fmt::format("{:.0f}", wall.framesPerSecond) : "at rest");
    row("triangles", count(triangles));
    row("screen error", fmt::format("{:.2f} px", error));
    const auto spread = [](const FrameMeter::Spread& times) {
        return fmt::format("{:.0f} ms, 99 %: {:.0f} ms", times.median, times.p99);
    };
    if (wall.latency.median > 0) row("camera to swap", spread(wall.latency));
    if (wall.latency.median > 0 && wall.interval.median > 0)
        row("in frames", fmt::format("{:.1f}", wall.latency.median / wall.interval.median));
    if (wall.interval.median > 0) row("swap to swap", spread(wall.interval));
    row("longest wait", fmt::format("{:.1f} ms", barrier));
}

}  // namespace

void drawStatus(const Flight& flight) {
    ImGui::SetNextWindowPos({16, 16});
    ImGui::Begin("Status", nullptr, kPanel);
    drawConnection(flight);
    if (flight.navigator() && flight.wall().frame &&
        ImGui::BeginTable("figures", 2, ImGuiTableFlags_SizingFixedFit)) {
        drawFrame(flight.wall());
        row(flight.navigator()->walking() ? "walking" : "flying",
            fmt::format("{:.3g} units a second", flight.navigator()->speed()));
        ImGui::EndTable();
    }
    ImGui::TextDisabled("H: help");
    ImGui::End();

    if (!flight.wall().welcome || !flight.wall().frame) return;
    ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - 16, 16}, ImGuiCond_Always, {1, 0});
    ImGui::Begin("Map", nullptr, kPanel);
    drawWallMap(*flight.wall().welcome, *flight.wall().frame);
    ImGui::End();
}

void drawNote(const Flight& flight) {
    const WallState& wall = flight.wall();
    const bool trouble = !wall.connected && !wall.trouble.empty();
    const bool note = !flight.note().empty() && ImGui::GetTime() - flight.noteTime() < kNoteSeconds;
    if (!trouble && !note) return;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({size.x / 2, size.y - 24}, ImGuiCond_Always, {0.5f, 1});
    ImGui::Begin("Note", nullptr, kPanel);
    if (trouble) {
        ImGui::TextColored(kBad, "%s", wall.trouble.c_str());
        ImGui::TextDisabled(wall.welcome ? "trying again; then the wall gets this camera and these settings"
                                         : "trying again");
    }
    if (note) ImGui::TextUnformatted(flight.note().c_str());
    ImGui::End();
}

}  // namespace iwalk::client
