#include "viewer/window/settings_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <optional>
#include <span>

#include "core/readable.h"
#include "render/create_rasterizer.h"
#include "viewer/session/colour_names.h"
#include "viewer/session/legend.h"
#include "viewer/window/item_positions.h"
#include "viewer/window/overlay.h"
#include "viewer/window/widgets.h"

namespace strata {
namespace {

float panelWidth() { return 330.0f * uiScale(); }

constexpr float kLeastBudget = 1e5f;  // points
constexpr float kMostBudget = 1e8f;

constexpr float kPlotHeight = 26.0f;
constexpr double kDegree = std::numbers::pi / 180.0;

/// Draws two sliders, which go from one end of `limits` to the other, and a button that brings `automatic` back.
template <typename Range>
bool drawRange(Range& range, const Range& limits, const Range& automatic, const char* format, ImGuiSliderFlags flags) {
  float low = static_cast<float>(range.x), high = static_cast<float>(range.y);
  const float least = static_cast<float>(limits.x), most = static_cast<float>(limits.y);
  using Number = decltype(range.x);
  bool changed = false;
  if (ImGui::SliderFloat("from", &low, least, most, format, flags)) {
    range.x = static_cast<Number>(low);
    changed = true;
  }
  if (ImGui::SliderFloat("to", &high, least, most, format, flags)) {
    range.y = static_cast<Number>(high);
    changed = true;
  }
  ImGui::SameLine();
  if (ImGui::SmallButton("auto")) {
    range = automatic;
    changed = true;
  }
  return changed;
}

void drawLegend(const Legend& legend) {
  if (!legend.colours.empty()) {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float width = 0.85f * panelWidth(), step = width / static_cast<float>(legend.colours.size());
    ImDrawList* canvas = ImGui::GetWindowDrawList();
    for (std::size_t i = 0; i < legend.colours.size(); ++i) {
      const float left = corner.x + step * static_cast<float>(i);
      canvas->AddRectFilled({left, corner.y}, {left + step + 0.5f, corner.y + 10.0f * uiScale()}, legend.colours[i]);
    }
    ImGui::Dummy(ImVec2(width, 10.0f * uiScale()));
    ImGui::TextDisabled("%s", legend.low.c_str());
    ImGui::SameLine(0.85f * panelWidth() - ImGui::CalcTextSize(legend.high.c_str()).x + 8.0f);
    ImGui::TextDisabled("%s", legend.high.c_str());
  }
  for (std::size_t i = 0; i < legend.entries.size(); ++i) {
    if (i % 2 == 1) ImGui::SameLine(0.48f * panelWidth());
    ImGui::ColorButton("##legend", ImGui::ColorConvertU32ToFloat4(legend.entries[i].colour),
                       ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop,
                       ImVec2(12.0f * uiScale(), 12.0f * uiScale()));
    ImGui::SameLine();
    ImGui::TextDisabled("%s", legend.entries[i].label.c_str());
  }
}

/// Gives the item drawn last a tooltip that says why it is disabled, where it is.
void explain(bool disabled, const char* why) {
  if (disabled && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) ImGui::SetTooltip("%s", why);
}

bool drawColour(DrawOptions& draw, const ColourLimits& limits, bool progressive) {
  bool changed = false;
  if (ImGui::BeginCombo("colour", colourName(draw.colour))) {
    for (int i = 0; i <= static_cast<int>(ColourMode::overdraw); ++i) {
      const auto mode = static_cast<ColourMode>(i);
      const bool disabled = progressive && mode == ColourMode::overdraw;
      ImGui::BeginDisabled(disabled);
      if (ImGui::Selectable(colourName(mode), mode == draw.colour)) {
        draw.colour = mode;
        changed = true;
      }
      ImGui::EndDisabled();
      explain(disabled, "Progressive drawing does not count overdraw.\nChoose another way below at \"drawn by\".");
    }
    ImGui::EndCombo();
  }
  noteItem("colour");
  if (draw.colour == ColourMode::intensity)
    changed = drawRange(draw.intensityRange, limits.intensity, limits.automatic.intensityRange, "%.0f",
                        ImGuiSliderFlags_Logarithmic) ||
              changed;
  if (draw.colour == ColourMode::elevation)
    changed = drawRange(draw.elevationRange, limits.elevation, limits.automatic.elevationRange, "%.2f m",
                        ImGuiSliderFlags_None) ||
              changed;
  drawLegend(legendOf(draw, limits.classes, limits.levels));
  return changed;
}

bool drawColourButton(const char* label, glm::u8vec3& colour) {
  float rgb[3] = {colour.x / 255.0f, colour.y / 255.0f, colour.z / 255.0f};
  if (!ImGui::ColorEdit3(label, rgb, ImGuiColorEditFlags_NoInputs)) return false;
  for (int c = 0; c < 3; ++c) colour[c] = static_cast<std::uint8_t>(std::lround(255.0f * rgb[c]));
  return true;
}

bool drawBackground(DrawOptions& draw) {
  bool changed = drawColourButton("background", draw.background);
  ImGui::SameLine();
  bool gradient = draw.backgroundBelow.has_value();
  if (ImGui::Checkbox("gradient", &gradient)) {
    draw.backgroundBelow = gradient ? std::optional(draw.background) : std::nullopt;
    changed = true;
  }
  if (!draw.backgroundBelow) return changed;
  ImGui::SameLine();
  return drawColourButton("below", *draw.backgroundBelow) || changed;
}

bool drawSettings(ViewerSettings& settings, const ColourLimits& limits, bool progressive) {
  bool changed = false;
  float budget = static_cast<float>(settings.selection.pointBudget);
  if (ImGui::SliderFloat("point budget", &budget, kLeastBudget, kMostBudget,
                         readableCount(static_cast<double>(budget)).c_str(),
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoInput)) {
    settings.selection.pointBudget = static_cast<std::uint64_t>(std::llround(budget));
    changed = true;
  }
  float density = static_cast<float>(settings.selection.pointsPerPixel);
  if (ImGui::SliderFloat("detail", &density, 0.05f, 8.0f, "%.2f points per pixel", ImGuiSliderFlags_Logarithmic)) {
    settings.selection.pointsPerPixel = static_cast<double>(density);
    changed = true;
  }
  changed = ImGui::SliderInt("point size", &settings.draw.pointSize, 1, 8, "%d px") || changed;
  changed = drawColour(settings.draw, limits, progressive) || changed;
  bool blended = settings.draw.shading == Shading::highQuality;
  ImGui::BeginDisabled(progressive);
  if (ImGui::Checkbox("high-quality shading", &blended)) {
    settings.draw.shading = blended ? Shading::highQuality : Shading::plain;
    changed = true;
  }
  ImGui::EndDisabled();
  noteItem("high-quality shading");
  explain(progressive, "Progressive drawing shades plainly.\nChoose another way below at \"drawn by\".");
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
  float degrees = static_cast<float>(settings.fovY / kDegree);
  if (ImGui::SliderFloat("field of view", &degrees, 10.0f, 120.0f, "%.0f degrees", ImGuiSliderFlags_AlwaysClamp)) {
    settings.fovY = static_cast<double>(degrees) * kDegree;
    changed = true;
  }
  changed = drawBackground(settings.draw) || changed;
  int backend = static_cast<int>(settings.backend);
  if (ImGui::Combo("drawn by", &backend, backendNames().data(), static_cast<int>(backendNames().size()))) {
    settings.backend = static_cast<Backend>(backend);
    changed = true;
  }
  return changed;
}

float valueColumn() { return 0.5f * panelWidth(); }

void plot(const char* name, const FrameHistory& history, FrameHistory::Series which, const std::string& value) {
  const std::span<const float> series = history.series(which);
  namedValue(name, value, valueColumn());
  ImGui::PushID(name);
  ImGui::PlotLines("##plot", series.data(), static_cast<int>(series.size()), 0, nullptr, 0.0f,
                   static_cast<float>(std::max(1.05 * history.largest(which), 1e-3)),
                   ImVec2(0.9f * panelWidth(), kPlotHeight * uiScale()));
  ImGui::PopID();
}

void drawSpeed(const SettingsPanelFacts& facts) {
  using Series = FrameHistory::Series;
  const FrameReport& frame = facts.frame;
  const FrameHistory& history = frame.history;
  plot("frame", history, Series::frameMs,
       readableMs(frame.frameMs) + ", at most " + readableMs(history.largest(Series::frameMs)));
  plot("points drawn", history, Series::pointsDrawn,
       readableCount(static_cast<double>(frame.draw.pointsDrawn)) + " of " +
           readableCount(static_cast<double>(facts.pointsInStores)));
  plot("nodes missing", history, Series::missingNodes,
       std::to_string(frame.missingNodes) + " of " + std::to_string(frame.nodesDrawn + frame.missingNodes) +
           (frame.complete ? "" : ", loading"));
  plot("queue", history, Series::queue, std::to_string(frame.streamer.queueLength));
  plot("from the disk", history, Series::readBytesPerSecond,
       readableBytes(history.latest(Series::readBytesPerSecond)) + "/s");
  const auto line = [](const char* name, const std::string& value) { namedValue(name, value, valueColumn()); };
  line("read", readableBytes(static_cast<double>(frame.streamer.bytesRead)));
  line("in memory", readableCount(frame.streamer.residentNodes) + " nodes, " +
                        readableBytes(static_cast<double>(frame.streamer.residentBytes)));
  char share[16];
  std::snprintf(share, sizeof share, "%.1f %%", 100.0 * history.latest(Series::hitRate));
  line("found there", share);
  line("moving (G)", modeName(facts.mode));
  if (frame.draw.gpuBytes > 0) line("on the GPU", readableBytes(static_cast<double>(frame.draw.gpuBytes)));
  line("LOD pass", readableMs(frame.streamer.lodMs));
  line("fly speed", readableCount(facts.flySpeed) + " m/s");
  if (frame.streamer.failures > 0)
    ImGui::TextColored(ImVec4(1.0f, 0.5f, 0.4f, 1.0f), "%llu reads failed, %llu nodes given up",
                       static_cast<unsigned long long>(frame.streamer.failures),
                       static_cast<unsigned long long>(frame.streamer.nodesGivenUp));
}

}  // namespace

bool drawSettingsPanel(ViewerSettings& settings, const ColourLimits& limits, const SettingsPanelFacts& facts,
                       InspectorPanel& inspector) {
  const float outer = panelWidth() + 12.0f;
  ImGui::SetNextWindowPos(ImVec2(12.0f, 12.0f), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints(ImVec2(outer, 0.0f), ImVec2(outer, ImGui::GetIO().DisplaySize.y - 24.0f));
  ImGui::SetNextWindowBgAlpha(0.82f);
  bool changed = false;
  if (ImGui::Begin("Strata", nullptr, ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize)) {
    ImGui::TextWrapped("%s", facts.layers.c_str());
    ImGui::TextDisabled("%s", facts.rasterizer.c_str());
    ImGui::PushItemWidth(0.55f * panelWidth());
    if (sectionHeader("Look", true)) changed = drawSettings(settings, limits, facts.progressive);
    if (sectionHeader("Speed", false)) drawSpeed(facts);
    if (sectionHeader("Inside", false)) inspector.drawSection(facts.frame.nodesDrawn);
    ImGui::PopItemWidth();
    ImGui::Separator();
    ImGui::TextDisabled("%s of %s points, %s", readableCount(static_cast<double>(facts.frame.draw.pointsDrawn)).c_str(),
                        readableCount(static_cast<double>(facts.pointsInStores)).c_str(),
                        readableMs(facts.frame.frameMs).c_str());
    if (!facts.notice.empty()) ImGui::TextWrapped("%s", facts.notice.c_str());
    ImGui::TextDisabled("H shows what keys and mouse do");
  }
  ImGui::End();
  return changed;
}

}  // namespace strata
