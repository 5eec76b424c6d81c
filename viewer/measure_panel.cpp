#include "viewer/measure_panel.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "viewer/camera_control.h"

namespace strata {
namespace {

constexpr float kWidth = 300.0f;  // pixels
constexpr float kMargin = 12.0f;
constexpr float kFigureGap = 12.0f;
constexpr ImU32 kLine = IM_COL32(255, 196, 0, 255);
constexpr ImU32 kCurrent = IM_COL32(64, 200, 255, 255);
constexpr ImU32 kShade = IM_COL32(0, 0, 0, 170);
constexpr std::array kKinds{MeasureKind::point, MeasureKind::distance, MeasureKind::height, MeasureKind::angle,
                            MeasureKind::area};

void drawPicked(const ToolsState& state) {
  if (state.lookingUp) ImGui::TextDisabled("reading ...");
  if (!state.picked) {
    if (!state.lookingUp) ImGui::TextDisabled("click a point to see its coordinates");
    return;
  }
  ImGui::TextWrapped("%s", state.picked->coordinates.c_str());
  if (ImGui::SmallButton("copy all")) {
    std::string text = state.picked->coordinates + "\n";
    for (const auto& [name, value] : state.picked->facts) text += name + ": " + value + "\n";
    ImGui::SetClipboardText(text.c_str());
  }
  ImGui::SameLine();
  if (ImGui::SmallButton("copy coordinates")) ImGui::SetClipboardText(state.picked->coordinates.c_str());
  for (const auto& [name, value] : state.picked->facts) {
    ImGui::TextDisabled("%s", name.c_str());
    ImGui::SameLine(0.42f * kWidth);
    ImGui::TextWrapped("%s", value.c_str());
  }
}

/// One line of the list of measurements. True when it is to be deleted.
bool drawMeasurementLine(Measurement& m) {
  ImGui::Checkbox("##visible", &m.visible);
  ImGui::SameLine();
  char name[64];
  std::snprintf(name, sizeof name, "%s", m.name.c_str());
  ImGui::SetNextItemWidth(0.34f * kWidth);
  if (ImGui::InputText("##name", name, sizeof name)) m.name = name;
  ImGui::SameLine();
  ImGui::TextUnformatted(measureText(m).c_str());
  ImGui::SameLine(kWidth - 34.0f);
  return ImGui::SmallButton("x");
}

void drawMeasure(ToolsState& state, ToolsRequest& request) {
  for (const MeasureKind kind : kKinds) {
    if (kind != kKinds.front()) ImGui::SameLine();
    const bool on = state.measure.active() && state.measure.current()->kind == kind;
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::SmallButton(measureName(kind))) on ? state.measure.finish() : state.measure.begin(kind);
    if (on) ImGui::PopStyleColor();
  }
  if (state.measure.active()) ImGui::TextDisabled("click points; Enter keeps, Backspace takes back,\nEscape drops");
  std::vector<Measurement>& kept = state.measure.kept();
  for (std::size_t i = 0; i < kept.size();) {
    ImGui::PushID(static_cast<int>(i));
    const bool dropped = drawMeasurementLine(kept[i]);
    ImGui::PopID();
    if (dropped)
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  }
  if (kept.empty()) return;
  request.exportCsv = ImGui::SmallButton("save CSV");
  ImGui::SameLine();
  request.exportGeoJson = ImGui::SmallButton("save GeoJSON");
}

void drawBookmarks(ToolsState& state, ToolsRequest& request) {
  request.addBookmark = ImGui::SmallButton("keep this view");
  ImGui::SameLine();
  request.saveProject = ImGui::SmallButton("save project");
  for (std::size_t i = 0; i < state.bookmarks.size();) {
    ImGui::PushID(static_cast<int>(1000 + i));
    if (ImGui::SmallButton("go")) request.goTo = state.bookmarks[i].view;
    ImGui::SameLine();
    char name[64];
    std::snprintf(name, sizeof name, "%s", state.bookmarks[i].name.c_str());
    ImGui::SetNextItemWidth(0.6f * kWidth);
    if (ImGui::InputText("##name", name, sizeof name)) state.bookmarks[i].name = name;
    ImGui::SameLine(kWidth - 34.0f);
    const bool dropped = ImGui::SmallButton("x");
    ImGui::PopID();
    if (dropped)
      state.bookmarks.erase(state.bookmarks.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  }
}

ImVec2 at(const glm::dvec2& pixel) {
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  return {static_cast<float>(pixel.x) / scale.x, static_cast<float>(pixel.y) / scale.y};
}

/// A text above the place it belongs to.
void drawFigure(const std::string& text, const View& view, const glm::dvec3& place, ImU32 colour) {
  if (text.empty() || depthOf(view, place) <= view.nearPlane) return;
  ImDrawList* canvas = ImGui::GetBackgroundDrawList();
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  ImVec2 corner = at(pixelOf(view, place));
  corner.x -= 0.5f * size.x;
  corner.y -= size.y + kFigureGap;
  canvas->AddRectFilled({corner.x - 4.0f, corner.y - 2.0f}, {corner.x + size.x + 4.0f, corner.y + size.y + 2.0f},
                        kShade, 3.0f);
  canvas->AddText(corner, colour, text.c_str());
}

void drawOne(const Measurement& m, const View& view, ImU32 colour) {
  ImDrawList* canvas = ImGui::GetBackgroundDrawList();
  const std::size_t count = m.points.size();
  const bool closed = m.kind == MeasureKind::area && count > 2;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < count; ++i)
    if (const auto segment = segmentOnScreen(view, m.points[i], m.points[(i + 1) % count])) {
      canvas->AddLine(at(segment->first), at(segment->second), kShade, 4.0f);
      canvas->AddLine(at(segment->first), at(segment->second), colour, 2.0f);
    }
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& p : m.points) middle += p / static_cast<double>(count);
  drawFigure(measureText(m), view, m.kind == MeasureKind::angle && count == 3 ? m.points[1] : middle, colour);
  for (const glm::dvec3& p : m.points) {
    if (depthOf(view, p) <= view.nearPlane) continue;
    canvas->AddCircleFilled(at(pixelOf(view, p)), 5.0f, kShade);
    canvas->AddCircleFilled(at(pixelOf(view, p)), 3.5f, colour);
  }
}

}  // namespace

ToolsRequest drawToolsPanel(ToolsState& state, int width) {
  ToolsRequest request;
  const float right = static_cast<float>(width) / ImGui::GetIO().DisplayFramebufferScale.x;
  ImGui::SetNextWindowPos(ImVec2(right - kMargin, kMargin), ImGuiCond_Appearing,
                          ImVec2(1.0f, 0.0f));  // its right upper corner
  const float outer = kWidth + 2.0f * kMargin;
  ImGui::SetNextWindowSizeConstraints(ImVec2(outer, 0.0f),
                                      ImVec2(outer, ImGui::GetIO().DisplaySize.y - 2.0f * kMargin));
  ImGui::SetNextWindowBgAlpha(0.82f);
  if (ImGui::Begin("Tools", nullptr, ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize)) {
    if (state.layers.size() > 1 && ImGui::CollapsingHeader("Layers", ImGuiTreeNodeFlags_DefaultOpen))
      for (std::size_t i = 0; i < state.layers.size(); ++i) {
        bool shown = state.shown[i];
        if (ImGui::Checkbox(state.layers[i].c_str(), &shown)) {
          state.shown[i] = shown;
          request.layersChanged = true;
        }
      }
    if (ImGui::CollapsingHeader("Point", ImGuiTreeNodeFlags_DefaultOpen)) drawPicked(state);
    if (ImGui::CollapsingHeader("Measure", ImGuiTreeNodeFlags_DefaultOpen)) drawMeasure(state, request);
    if (ImGui::CollapsingHeader("Keep", ImGuiTreeNodeFlags_DefaultOpen)) drawBookmarks(state, request);
  }
  ImGui::End();
  return request;
}

void drawMeasurements(const MeasureTool& tool, const View& view, const std::optional<PickedPoint>& picked) {
  for (const Measurement& m : tool.kept())
    if (m.visible) drawOne(m, view, kLine);
  if (tool.current() && !tool.current()->points.empty()) drawOne(*tool.current(), view, kCurrent);
  if (!picked || depthOf(view, picked->position) <= view.nearPlane) return;
  ImGui::GetBackgroundDrawList()->AddCircle(at(pixelOf(view, picked->position)), 7.0f, kCurrent, 0, 2.0f);
}

}  // namespace strata
