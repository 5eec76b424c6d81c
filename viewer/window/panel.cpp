#include "viewer/window/panel.h"

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
#include "viewer/session/drawing.h"
#include "viewer/session/legend.h"
#include "viewer/window/item_positions.h"
#include "viewer/window/overlay.h"

namespace strata {
namespace {

float panelWidth() { return 330.0f * uiScale(); }

constexpr float kLeastBudget = 1e5f;  // points
constexpr float kMostBudget = 1e8f;

constexpr float kPlotHeight = 26.0f;
constexpr double kDegree = std::numbers::pi / 180.0;

/// Two sliders from `least` to `most` and a button that brings `automatic` back.
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

/// Why the item drawn last is grey.
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
  if (ImGui::SliderFloat("detail", &density, 0.05f, 8.0f, "%.2f points a pixel", ImGuiSliderFlags_Logarithmic)) {
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

void line(const char* name, const std::string& value) {
  ImGui::TextUnformatted(name);
  ImGui::SameLine(0.5f * panelWidth());
  ImGui::TextUnformatted(value.c_str());
}

void plot(const char* name, const FrameHistory& history, FrameHistory::Series which, const std::string& value) {
  const std::span<const float> series = history.series(which);
  line(name, value);
  ImGui::PushID(name);
  ImGui::PlotLines("##plot", series.data(), static_cast<int>(series.size()), 0, nullptr, 0.0f,
                   static_cast<float>(std::max(1.05 * history.largest(which), 1e-3)),
                   ImVec2(0.9f * panelWidth(), kPlotHeight * uiScale()));
  ImGui::PopID();
}

void drawStats(const ViewerStats& stats) {
  using Series = FrameHistory::Series;
  const FrameHistory& history = stats.history;
  plot("frame", history, Series::frameMs,
       readableMs(stats.frameMs) + ", at most " + readableMs(history.largest(Series::frameMs)));
  plot("points drawn", history, Series::pointsDrawn,
       readableCount(static_cast<double>(stats.draw.pointsDrawn)) + " of " +
           readableCount(static_cast<double>(stats.pointsInStores)));
  plot("nodes missing", history, Series::missingNodes,
       std::to_string(stats.missingNodes) + " of " + std::to_string(stats.nodesDrawn + stats.missingNodes) +
           (stats.complete ? "" : ", loading"));
  plot("queue", history, Series::queue, std::to_string(stats.streamer.queueLength));
  plot("from the disk", history, Series::readBytesPerSecond,
       readableBytes(history.latest(Series::readBytesPerSecond)) + "/s");
  line("read", readableBytes(static_cast<double>(stats.streamer.bytesRead)));
  line("in memory", readableCount(stats.streamer.residentNodes) + " nodes, " +
                        readableBytes(static_cast<double>(stats.streamer.residentBytes)));
  char share[16];
  std::snprintf(share, sizeof share, "%.1f %%", 100.0 * history.latest(Series::hitRate));
  line("found there", share);
  line("moving (G)", modeName(stats.mode));
  if (stats.draw.gpuBytes > 0) line("on the GPU", readableBytes(static_cast<double>(stats.draw.gpuBytes)));
  line("LOD pass", readableMs(stats.streamer.lodMs));
  line("fly speed", readableCount(stats.flySpeed) + " m/s");
  if (stats.streamer.failures > 0)
    ImGui::TextColored(ImVec4(1.0f, 0.5f, 0.4f, 1.0f), "%llu reads failed, %llu nodes given up",
                       static_cast<unsigned long long>(stats.streamer.failures),
                       static_cast<unsigned long long>(stats.streamer.nodesGivenUp));
}

}  // namespace

void drawHelp(bool& open) {
  if (!open) return;
  constexpr const char* kKeys[][2] = {{"left drag", "orbit around the point under the cursor"},
                                      {"right drag", "pan; the point stays under the cursor"},
                                      {"wheel", "nearer to the point under the cursor, away"},
                                      {"click", "coordinates and attributes of the point; a measurement's next point"},
                                      {"double click", "go to the point"},
                                      {"G", "the next way of moving: orbit, fly, earth"},
                                      {"    fly", "left drag turns the head, the wheel sets the speed"},
                                      {"    earth", "left drag slides over the ground, right drag orbits"},
                                      {"W A S D, E Q", "fly; shift: five times as fast"},
                                      {"F", "show everything"},
                                      {"1 3 7", "from the front, the side, the top"},
                                      {"O", "with perspective, without"},
                                      {"M, X", "measure a distance, a cross-section"},
                                      {"B", "new clip box; drag its dots"},
                                      {"Enter, Backspace, Escape", "measuring: keep, take back a point, drop"},
                                      {"P", "pictures of any size, camera paths, films"},
                                      {"K, R, space", "camera path: set a key, record, play"},
                                      {"Control + P", "take the picture at once"},
                                      {"Control + S, Control + Q", "save the project (and the path), quit"},
                                      {"H, F1", "this help"}};
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.5f * size.y), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
  if (ImGui::Begin("Keys and mouse", &open, ImGuiWindowFlags_AlwaysAutoResize))
    for (const auto& key : kKeys) {
      ImGui::TextUnformatted(key[0]);
      ImGui::SameLine(15.0f * ImGui::GetFontSize());
      ImGui::TextUnformatted(key[1]);
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

void drawSpinner(const ViewerStats& stats) {
  if (stats.complete) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float turn = static_cast<float>(4.0 * std::fmod(ImGui::GetTime(), std::numbers::pi / 2.0));
  ImDrawList* canvas = ImGui::GetBackgroundDrawList();
  const float unit = uiScale();
  canvas->PathArcTo(ImVec2(size.x - 28.0f * unit, size.y - 28.0f * unit), 9.0f * unit, turn, turn + 4.5f);
  canvas->PathStroke(IM_COL32(255, 255, 255, 110), 0, 2.5f * unit);
}

namespace {

/// A text on a dark ground, in the middle, `top` down from the upper edge.
void drawPill(const std::string& text, float top, ImU32 colour) {
  ImDrawList* canvas = ImGui::GetBackgroundDrawList();
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float left = 0.5f * (ImGui::GetIO().DisplaySize.x - size.x), rim = 6.0f * uiScale();
  canvas->AddRectFilled({left - 1.6f * rim, top - rim}, {left + size.x + 1.6f * rim, top + size.y + rim},
                        IM_COL32(0, 0, 0, 190), 5.0f * uiScale());
  canvas->AddText({left, top}, colour, text.c_str());
}

}  // namespace

void drawHint(const std::string& text) {
  if (!text.empty()) drawPill(text, 16.0f * uiScale(), IM_COL32(64, 200, 255, 255));
}

void drawFlySpeed(const ViewerStats& stats) {
  if (stats.flying)
    drawPill(readableCount(stats.flySpeed) + " m/s", ImGui::GetIO().DisplaySize.y - 32.0f * uiScale(),
             IM_COL32(255, 255, 255, 220));
}

bool drawPanel(ViewerSettings& settings, const ViewerStats& stats, const ColourLimits& limits,
               const std::function<void()>& inside) {
  const float outer = panelWidth() + 12.0f;
  ImGui::SetNextWindowPos(ImVec2(12.0f, 12.0f), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints(ImVec2(outer, 0.0f), ImVec2(outer, ImGui::GetIO().DisplaySize.y - 24.0f));
  ImGui::SetNextWindowBgAlpha(0.82f);
  bool changed = false;
  if (ImGui::Begin("Strata", nullptr, ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize)) {
    ImGui::TextWrapped("%s", stats.layers.c_str());
    ImGui::TextDisabled("%s", stats.rasterizer.c_str());
    ImGui::PushItemWidth(0.55f * panelWidth());
    if (ImGui::CollapsingHeader("Look", ImGuiTreeNodeFlags_DefaultOpen))
      changed = drawSettings(settings, limits, stats.progressive);
    if (ImGui::CollapsingHeader("Speed")) drawStats(stats);
    if (ImGui::CollapsingHeader("Inside")) inside();
    ImGui::PopItemWidth();
    ImGui::Separator();
    ImGui::TextDisabled("%s of %s points, %s", readableCount(static_cast<double>(stats.draw.pointsDrawn)).c_str(),
                        readableCount(static_cast<double>(stats.pointsInStores)).c_str(),
                        readableMs(stats.frameMs).c_str());
    if (!stats.notice.empty()) ImGui::TextWrapped("%s", stats.notice.c_str());
    ImGui::TextDisabled("H shows what keys and mouse do");
  }
  ImGui::End();
  return changed;
}

}  // namespace strata
