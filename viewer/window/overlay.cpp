#include "viewer/window/overlay.h"

#include <imgui.h>

#include "viewer/camera/camera_control.h"

namespace strata {
namespace {

constexpr std::uint32_t kShade = 0xaa000000u;
constexpr float kTextGap = 12.0f;  // pixels between a text and its place
constexpr float kRim = 2.0f;
constexpr float kOrdinaryLetters = 13.0f;  // pixels high

ImVec2 at(const glm::dvec2& pixel) {
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  return {static_cast<float>(pixel.x) / scale.x, static_cast<float>(pixel.y) / scale.y};
}

bool isBefore(const View& view, const glm::dvec3& place) { return depthOf(view, place) > view.nearPlane; }

}  // namespace

float uiScale() { return ImGui::GetFontSize() / kOrdinaryLetters; }

void overlayLine(const View& view, const glm::dvec3& a, const glm::dvec3& b, std::uint32_t colour, float widthPx) {
  if (const auto segment = segmentOnScreen(view, a, b))
    ImGui::GetBackgroundDrawList()->AddLine(at(segment->first), at(segment->second), colour, widthPx * uiScale());
}

void overlayRimmedLine(const View& view, const glm::dvec3& a, const glm::dvec3& b, std::uint32_t colour) {
  overlayLine(view, a, b, kShade, 2.0f + kRim);
  overlayLine(view, a, b, colour, 2.0f);
}

void overlayDot(const View& view, const glm::dvec3& place, std::uint32_t colour, float radiusPx) {
  if (!isBefore(view, place)) return;
  ImDrawList* canvas = ImGui::GetBackgroundDrawList();
  canvas->AddCircleFilled(at(pixelOf(view, place)), (radiusPx + 1.5f) * uiScale(), kShade);
  canvas->AddCircleFilled(at(pixelOf(view, place)), radiusPx * uiScale(), colour);
}

void overlayRing(const View& view, const glm::dvec3& place, std::uint32_t colour, float radiusPx) {
  if (isBefore(view, place))
    ImGui::GetBackgroundDrawList()->AddCircle(at(pixelOf(view, place)), radiusPx * uiScale(), colour, 0,
                                              2.0f * uiScale());
}

void overlayText(const View& view, const glm::dvec3& place, const std::string& text, std::uint32_t colour) {
  if (text.empty() || !isBefore(view, place)) return;
  ImDrawList* canvas = ImGui::GetBackgroundDrawList();
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  ImVec2 corner = at(pixelOf(view, place));
  corner.x -= 0.5f * size.x;
  corner.y -= size.y + kTextGap;
  canvas->AddRectFilled({corner.x - 4.0f, corner.y - 2.0f}, {corner.x + size.x + 4.0f, corner.y + size.y + 2.0f},
                        kShade, 3.0f);
  canvas->AddText(corner, colour, text.c_str());
}

}  // namespace strata
