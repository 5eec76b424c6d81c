#include "viewer/panel.h"

#include <imgui.h>

#include <cmath>

#include "viewer/html_text.h"

namespace strata {
namespace {

constexpr float kWidth = 330.0f;      // pixels
constexpr float kLeastBudget = 1e5f;  // points
constexpr float kMostBudget = 1e8f;

bool drawSettings(ViewerSettings& settings) {
  bool changed = false;
  float budget = static_cast<float>(settings.selection.pointBudget);
  if (ImGui::SliderFloat("points", &budget, kLeastBudget, kMostBudget, readableCount(budget).c_str(),
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoInput)) {
    settings.selection.pointBudget = static_cast<std::uint64_t>(std::llround(budget));
    changed = true;
  }
  float density = static_cast<float>(settings.selection.pointsPerPixel);
  if (ImGui::SliderFloat("a pixel", &density, 0.05f, 8.0f, "%.2f points", ImGuiSliderFlags_Logarithmic)) {
    settings.selection.pointsPerPixel = static_cast<double>(density);
    changed = true;
  }
  changed = ImGui::SliderInt("size", &settings.draw.pointSize, 1, 8, "%d px") || changed;
  // In the order of ColourMode.
  int mode = static_cast<int>(settings.draw.colour);
  if (ImGui::Combo("colour", &mode,
                   "rgb\0intensity\0elevation\0classification\0level\0return\0normal\0precision\0overdraw\0")) {
    settings.draw.colour = static_cast<ColourMode>(mode);
    changed = true;
  }
  bool blended = settings.draw.shading == Shading::highQuality;
  if (ImGui::Checkbox("high-quality shading", &blended)) {
    settings.draw.shading = blended ? Shading::highQuality : Shading::plain;
    changed = true;
  }
  constexpr int kJumpFlood = 4;
  int fill = settings.draw.jumpFlood ? kJumpFlood : settings.draw.fill / 2;
  if (ImGui::Combo("fill holes", &fill, "no\0003 x 3\0005 x 5\0007 x 7\0by jump flooding\0")) {
    settings.draw.jumpFlood = fill == kJumpFlood;
    settings.draw.fill = settings.draw.jumpFlood ? 1 : 2 * fill + 1;
    changed = true;
  }
  changed = ImGui::Checkbox("eye-dome lighting", &settings.draw.edl) || changed;
  if (settings.draw.edl)
    changed = ImGui::SliderFloat("strength", &settings.draw.edlStrength, 0.1f, 4.0f, "%.1f") || changed;
  return changed;
}

void line(const char* name, const std::string& value) {
  ImGui::TextUnformatted(name);
  ImGui::SameLine(0.5f * kWidth);
  ImGui::TextUnformatted(value.c_str());
}

void drawStats(const ViewerStats& stats) {
  line("frame", readableMs(stats.frameMs));
  line("points drawn", readableCount(static_cast<double>(stats.draw.pointsDrawn)));
  line("of", readableCount(static_cast<double>(stats.pointsInStores)));
  line("nodes in memory", readableCount(stats.streamer.residentNodes) + ", " +
                              readableBytes(static_cast<double>(stats.streamer.residentBytes)));
  line("missing nodes", std::to_string(stats.missingNodes) + (stats.complete ? ", complete" : ", loading"));
  line("read", readableBytes(static_cast<double>(stats.streamer.bytesRead)));
  line("fly speed", readableCount(stats.flySpeed) + " m/s");
  line("LOD pass", readableMs(stats.streamer.lodMs));
  if (stats.draw.gpuBytes > 0) line("on the GPU", readableBytes(static_cast<double>(stats.draw.gpuBytes)));
  if (stats.streamer.failures > 0)
    ImGui::TextColored(ImVec4(1.0f, 0.5f, 0.4f, 1.0f), "%llu nodes could not be read",
                       static_cast<unsigned long long>(stats.streamer.failures));
}

}  // namespace

void drawHelp(bool& open) {
  if (!open) return;
  constexpr const char* kKeys[][2] = {{"left drag", "orbit around the point under the cursor"},
                                      {"right drag", "pan; the point stays under the cursor"},
                                      {"wheel", "nearer to the point under the cursor, away"},
                                      {"click", "coordinates and attributes of the point; a measurement's next point"},
                                      {"double click", "go to the point"},
                                      {"W A S D, E Q", "fly; shift: five times as fast"},
                                      {"F", "show everything"},
                                      {"1 3 7", "from the front, the side, the top"},
                                      {"O", "with perspective, without"},
                                      {"M", "measure a distance"},
                                      {"Enter, Backspace, Escape", "measuring: keep, take back a point, drop"},
                                      {"Control + S, Control + Q", "save the project, quit"},
                                      {"H, F1", "this help"}};
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.5f * size.y), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
  if (ImGui::Begin("Keys and mouse", &open, ImGuiWindowFlags_AlwaysAutoResize))
    for (const auto& key : kKeys) {
      ImGui::TextUnformatted(key[0]);
      ImGui::SameLine(190.0f);
      ImGui::TextUnformatted(key[1]);
    }
  ImGui::End();
}

void drawError(std::string& text) {
  if (text.empty()) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, size.y - 24.0f), ImGuiCond_Always, ImVec2(0.5f, 1.0f));
  ImGui::SetNextWindowSizeConstraints(ImVec2(280.0f, 0.0f), ImVec2(0.8f * size.x, size.y));
  if (ImGui::Begin("Something went wrong", nullptr,
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing)) {
    ImGui::PushTextWrapPos(0.7f * size.x);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    if (ImGui::SmallButton("close")) text.clear();
  }
  ImGui::End();
}

bool drawPanel(ViewerSettings& settings, const ViewerStats& stats) {
  ImGui::SetNextWindowPos(ImVec2(12.0f, 12.0f), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize(ImVec2(kWidth, 0.0f), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowBgAlpha(0.82f);
  bool changed = false;
  if (ImGui::Begin("Strata", nullptr, ImGuiWindowFlags_NoFocusOnAppearing)) {
    ImGui::TextWrapped("%s", stats.layers.c_str());
    ImGui::TextDisabled("%s", stats.rasterizer.c_str());
    ImGui::Separator();
    ImGui::PushItemWidth(0.55f * kWidth);
    changed = drawSettings(settings);
    ImGui::PopItemWidth();
    ImGui::Separator();
    drawStats(stats);
    ImGui::Separator();
    if (!stats.notice.empty()) ImGui::TextWrapped("%s", stats.notice.c_str());
    ImGui::TextDisabled("H shows what keys and mouse do");
  }
  ImGui::End();
  return changed;
}

}  // namespace strata
