#include "viewer/window/progressive_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "core/readable.h"
#include "viewer/window/overlay.h"
#include "viewer/window/widgets.h"

namespace strata {
namespace {

float panelWidth() { return 300.0f * uiScale(); }

constexpr float kLeastPoints = 1e4f, kMostPoints = 1e8f;

void line(const char* name, const std::string& value) { namedValue(name, value, 0.5f * panelWidth()); }

std::string count(std::uint64_t value) { return readableCount(static_cast<double>(value)); }

bool pointsSlider(const char* name, std::uint64_t& points) {
  float value = static_cast<float>(points);
  if (!ImGui::SliderFloat(name, &value, kLeastPoints, kMostPoints, count(points).c_str(),
                          ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoInput))
    return false;
  points = static_cast<std::uint64_t>(std::llround(value));
  return true;
}

}  // namespace

bool drawProgressivePanel(ProgressiveRasterizer& rasterizer) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const ProgressiveStats& stats = rasterizer.progress();
  ProgressiveOptions options = rasterizer.options();
  bool changed = false;
  ImGui::SetNextWindowPos(ImVec2(size.x - 12.0f, size.y - 12.0f), ImGuiCond_FirstUseEver, ImVec2(1.0f, 1.0f));
  ImGui::SetNextWindowSize(ImVec2(panelWidth(), 0.0f), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowBgAlpha(0.82f);
  if (ImGui::Begin("Progressive", nullptr, ImGuiWindowFlags_NoFocusOnAppearing)) {
    ImGui::PushItemWidth(0.55f * panelWidth());
    changed = pointsSlider("per frame", options.pointsPerFrame);
    changed = pointsSlider("uploaded", options.uploadPerFrame) || changed;
    ImGui::PopItemWidth();
    ImGui::Separator();
    const auto used = static_cast<float>(stats.poolPoints - stats.poolFree) / static_cast<float>(stats.poolPoints);
    ImGui::ProgressBar(used, ImVec2(-1.0f, 0.0f));
    line("pool", count(stats.poolPoints) + ", " + readableBytes(static_cast<double>(stats.gpuBytes)));
    line("shown of it", count(stats.shownPoints));
    const std::uint64_t n = std::max<std::uint64_t>(options.pointsPerFrame, 1);
    line("turn", count(stats.turnPlaces) + ", " + std::to_string((stats.turnPlaces + n - 1) / n) + " frames");
    line("pieces", count(stats.pieces) + ", " + count(stats.ghostPieces) + " freed");
    line("importance", std::to_string(stats.leastImportance) + " to " + std::to_string(stats.mostImportance));
    line("reprojected", count(stats.reprojected) + " points");
    line("filled", count(stats.filled) + " places");
    line("written", count(stats.written) + " points");
    ImGui::Separator();
    line("all of a frame", readableMs(stats.uploadMs + stats.clearMs + stats.reprojectMs + stats.fillMs +
                                      stats.indexMs + stats.keepMs + stats.readMs + stats.resolveMs));
    line("upload", readableMs(stats.uploadMs));
    line("clear", readableMs(stats.clearMs));
    line("reproject", readableMs(stats.reprojectMs));
    line("fill", readableMs(stats.fillMs));
    line("index", readableMs(stats.indexMs));
    line("keep", readableMs(stats.keepMs));
    line("read back", readableMs(stats.readMs));
    line("resolve", readableMs(stats.resolveMs));
  }
  ImGui::End();
  if (changed) rasterizer.setOptions(options);
  return changed;
}

}  // namespace strata
