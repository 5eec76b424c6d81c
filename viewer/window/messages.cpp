#include "viewer/window/messages.h"

#include <imgui.h>

#include <cmath>
#include <numbers>

#include "core/readable.h"
#include "viewer/window/item_positions.h"
#include "viewer/window/key_bindings.h"
#include "viewer/window/overlay.h"

namespace strata {
namespace {

void helpLine(const char* input, const char* explanation) {
  ImGui::TextUnformatted(input);
  ImGui::SameLine(15.0f * ImGui::GetFontSize());
  ImGui::TextUnformatted(explanation);
}

/// A text on a dark ground, centred, `top` below the upper edge of the window.
void drawPill(const std::string& text, float top, ImU32 colour) {
  ImDrawList* canvas = ImGui::GetBackgroundDrawList();
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float left = 0.5f * (ImGui::GetIO().DisplaySize.x - size.x), rim = 6.0f * uiScale();
  canvas->AddRectFilled({left - 1.6f * rim, top - rim}, {left + size.x + 1.6f * rim, top + size.y + rim},
                        IM_COL32(0, 0, 0, 190), 5.0f * uiScale());
  canvas->AddText({left, top}, colour, text.c_str());
}

}  // namespace

void drawHelp(bool& open) {
  if (!open) return;
  constexpr const char* kMouse[][2] = {{"left drag", "orbit around the point under the cursor"},
                                       {"right drag", "pan; the point stays under the cursor"},
                                       {"wheel", "nearer to the point under the cursor, away"},
                                       {"click", "coordinates and attributes of the point; a measurement's next point"},
                                       {"double click", "go to the point; end a polyline, an area, a profile"},
                                       {"way of moving: fly", "left drag turns the head, the wheel sets the speed"},
                                       {"way of moving: earth", "left drag slides over the ground, right drag orbits"},
                                       {"W A S D, E Q", "fly; shift: five times as fast"}};
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.5f * size.y), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
  if (ImGui::Begin("Keys and mouse", &open, ImGuiWindowFlags_AlwaysAutoResize)) {
    for (const auto& [input, explanation] : kMouse) helpLine(input, explanation);
    for (const KeyBinding& binding : keyBindings()) helpLine(binding.keyName, binding.explanation);
  }
  ImGui::End();
}

void drawError(std::string& text) {
  if (text.empty()) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, size.y - 24.0f), ImGuiCond_Always, ImVec2(0.5f, 1.0f));
  ImGui::SetNextWindowSizeConstraints(ImVec2(280.0f * uiScale(), 0.0f), ImVec2(0.8f * size.x, size.y));
  if (ImGui::Begin("Something went wrong", nullptr,
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing)) {
    ImGui::PushTextWrapPos(0.7f * size.x);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    if (ImGui::SmallButton("close")) text.clear();
    noteItem("close the message");
  }
  ImGui::End();
}

void drawHint(const std::string& text) {
  if (!text.empty()) drawPill(text, 16.0f * uiScale(), IM_COL32(64, 200, 255, 255));
}

void drawFlySpeed(double speed) {
  drawPill(readableCount(speed) + " m/s", ImGui::GetIO().DisplaySize.y - 32.0f * uiScale(),
           IM_COL32(255, 255, 255, 220));
}

void drawSpinner() {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float turn = static_cast<float>(4.0 * std::fmod(ImGui::GetTime(), std::numbers::pi / 2.0));
  ImDrawList* canvas = ImGui::GetBackgroundDrawList();
  const float unit = uiScale();
  canvas->PathArcTo(ImVec2(size.x - 28.0f * unit, size.y - 28.0f * unit), 9.0f * unit, turn, turn + 4.5f);
  canvas->PathStroke(IM_COL32(255, 255, 255, 110), 0, 2.5f * unit);
}

}  // namespace strata
