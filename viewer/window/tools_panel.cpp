#include "viewer/window/tools_panel.h"

#include <imgui.h>

#include <algorithm>

#include "viewer/window/filter_panel.h"
#include "viewer/window/overlay.h"
#include "viewer/window/widgets.h"

namespace strata {
namespace {

float panelWidth() { return 300.0f * uiScale(); }

constexpr float kMargin = 12.0f;
constexpr std::uint32_t kLine = 0xff00c4ffu;
constexpr std::uint32_t kCurrent = 0xffffc840u;

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
    ImGui::SameLine(0.46f * panelWidth());
    const bool isPath = value.starts_with('/');  // too long for the panel: its last name is shown, the tooltip has all
    ImGui::TextWrapped("%s", isPath ? value.substr(value.rfind('/') + 1).c_str() : value.c_str());
    if (isPath && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", value.c_str());
  }
}

/// Draws one measurement of the list, which takes two lines. True when it is to be deleted; `show` turns true when the
/// window of a profile is to open.
bool drawMeasurementLine(Measurement& m, bool& show) {
  ImGui::Checkbox("##visible", &m.visible);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(0.42f * panelWidth());
  inputText("##name", m.name);
  ImGui::SameLine();
  if (m.kind == MeasureKind::profile) {
    show = ImGui::SmallButton("show");
    ImGui::SameLine();
  }
  if (ImGui::SmallButton("copy")) ImGui::SetClipboardText((m.name + ": " + measureText(m)).c_str());
  ImGui::SameLine(panelWidth() - 34.0f * uiScale());
  const bool dropped = ImGui::SmallButton("x");
  ImGui::Indent(28.0f * uiScale());
  ImGui::TextUnformatted(measureText(m).c_str());
  ImGui::Unindent(28.0f * uiScale());
  return dropped;
}

void drawMeasuring(ToolsState& state) {
  const Measurement& current = *state.measure.current();
  const std::size_t least = leastPoints(current.kind), count = current.points.size();
  if (count >= least && ImGui::SmallButton("done")) state.measure.finish();
  if (count >= least) ImGui::SameLine();
  if (state.measure.active() && ImGui::SmallButton("stop measuring")) state.measure.cancel();
}

void drawMeasure(ToolsState& state, ToolsRequest& request) {
  for (const MeasureKind kind : kMeasureKinds) {
    if (kind != kMeasureKinds.front() && kind != MeasureKind::angle) ImGui::SameLine();
    const bool on = state.measure.active() && state.measure.current()->kind == kind;
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::SmallButton(measureName(kind))) on ? state.measure.finish() : state.measure.begin(kind);
    if (on) ImGui::PopStyleColor();
  }
  if (state.measure.active()) drawMeasuring(state);
  std::vector<Measurement>& kept = state.measure.kept();
  for (std::size_t i = 0; i < kept.size();) {
    ImGui::PushID(static_cast<int>(i));
    bool show = false;
    const bool dropped = drawMeasurementLine(kept[i], show);
    if (show) request.showProfile = i;
    ImGui::PopID();
    if (dropped)
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  }
  if (kept.empty()) return;
  if (ImGui::SmallButton("copy all")) ImGui::SetClipboardText(measurementsCsv(kept).c_str());
  ImGui::SameLine();
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
    ImGui::SetNextItemWidth(0.6f * panelWidth());
    inputText("##name", state.bookmarks[i].name);
    ImGui::SameLine(panelWidth() - 34.0f * uiScale());
    const bool dropped = ImGui::SmallButton("x");
    ImGui::PopID();
    if (dropped)
      state.bookmarks.erase(state.bookmarks.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  }
}

/// Draws the outline of a profile's slab, segment by segment, at the heights of its points.
void drawSlab(const Measurement& m, const View& view, std::uint32_t colour) {
  for (std::size_t i = 0; i + 1 < m.points.size(); ++i) {
    const glm::dvec3 &a = m.points[i], &b = m.points[i + 1];
    const glm::dvec2 way(b - a);
    if (!(glm::length(way) > 0.0)) continue;
    const glm::dvec3 side(glm::normalize(glm::dvec2(-way.y, way.x)) * (0.5 * m.width), 0.0);
    overlayLine(view, a + side, b + side, colour, 1.0f);
    overlayLine(view, a - side, b - side, colour, 1.0f);
    overlayLine(view, a + side, a - side, colour, 1.0f);
    overlayLine(view, b + side, b - side, colour, 1.0f);
  }
}

void drawOne(const Measurement& m, const View& view, std::uint32_t colour) {
  const std::size_t count = m.points.size();
  const bool closed = m.kind == MeasureKind::area && count > 2;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < count; ++i)
    overlayRimmedLine(view, m.points[i], m.points[(i + 1) % count], colour);
  if (m.kind == MeasureKind::profile) drawSlab(m, view, colour);
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& p : m.points) middle += p / static_cast<double>(count);
  overlayText(view, m.kind == MeasureKind::angle && count == 3 ? m.points[1] : middle, measureText(m), colour);
  for (const glm::dvec3& p : m.points) overlayDot(view, p, colour, 3.5f);
}

}  // namespace

ToolsRequest drawToolsPanel(ToolsState& state, const View& view, const Box& bounds) {
  ToolsRequest request;
  const float right = static_cast<float>(view.width) / ImGui::GetIO().DisplayFramebufferScale.x;
  ImGui::SetNextWindowPos(ImVec2(right - kMargin, kMargin), ImGuiCond_Appearing,
                          ImVec2(1.0f, 0.0f));  // its right upper corner
  const float outer = panelWidth() + 2.0f * kMargin;
  ImGui::SetNextWindowSizeConstraints(ImVec2(outer, 0.0f),
                                      ImVec2(outer, ImGui::GetIO().DisplaySize.y - 2.0f * kMargin));
  ImGui::SetNextWindowBgAlpha(0.82f);
  if (ImGui::Begin("Tools", nullptr, ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize)) {
    if (state.layers.size() > 1 && sectionHeader("Layers", true))
      for (std::size_t i = 0; i < state.layers.size(); ++i) {
        bool shown = state.shown[i];
        if (ImGui::Checkbox(state.layers[i].c_str(), &shown)) {
          state.shown[i] = shown;
          request.layersChanged = true;
        }
      }
    if (sectionHeader("Point", true)) drawPicked(state);
    if (sectionHeader("Measure", true)) drawMeasure(state, request);
    if (sectionHeader("Clip", false))
      request.pictureChanged = drawClipSection(state.clip, view, bounds) || request.pictureChanged;
    if (sectionHeader("Classes", false))
      request.pictureChanged = drawClassSection(state.census.present(), state.classes) || request.pictureChanged;
    if (sectionHeader("Keep", true)) drawBookmarks(state, request);
  }
  ImGui::End();
  return request;
}

void drawMeasurements(const MeasureTool& tool, const View& view, const std::optional<PickedPoint>& picked) {
  for (const Measurement& m : tool.kept())
    if (m.visible) drawOne(m, view, kLine);
  if (tool.current() && !tool.current()->points.empty()) drawOne(*tool.current(), view, kCurrent);
  if (picked) overlayRing(view, picked->position, kCurrent, 7.0f);
}

}  // namespace strata
