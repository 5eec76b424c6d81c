#include "viewer/window/filter_panel.h"

#include <imgui.h>

#include <algorithm>

#include "render/picture/colour_map.h"
#include "viewer/session/class_census.h"
#include "viewer/window/item_positions.h"
#include "viewer/window/overlay.h"
#include "viewer/window/widgets.h"

namespace strata {
namespace {

constexpr std::uint32_t kBoxColour = 0xff60d0f0u;
constexpr std::uint32_t kCutoutColour = 0xff7080ffu;
constexpr std::uint32_t kHeldColour = 0xffffffffu;
constexpr float kHandlePx = 5.0f;
constexpr double kDragStep = 0.002;  // of the box's size, for a drag of one pixel

/// Draws three numbers that can be dragged and typed. True when one was changed.
bool drawCorner(const char* label, glm::dvec3& corner, double step) {
  double numbers[3] = {corner.x, corner.y, corner.z};
  const bool changed =
      ImGui::DragScalarN(label, ImGuiDataType_Double, numbers, 3, static_cast<float>(step), nullptr, nullptr, "%.2f");
  if (changed) corner = {numbers[0], numbers[1], numbers[2]};
  return changed;
}

/// Draws one box of the list. True when something was changed; `remove` turns true when the box is to go.
bool drawBox(ClipBox& box, bool& remove) {
  bool changed = ImGui::Checkbox("##on", &box.on);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(90.0f * uiScale());
  inputText("##name", box.name);
  ImGui::SameLine();
  int mode = box.cutout ? 1 : 0;
  ImGui::SetNextItemWidth(120.0f * uiScale());
  if (ImGui::Combo("##mode", &mode, "show inside\0show outside\0")) {
    box.cutout = mode == 1;
    changed = true;
  }
  ImGui::SameLine();
  remove = ImGui::SmallButton("x");
  const double step = kDragStep * std::max({box.box.size().x, box.box.size().y, box.box.size().z});
  ImGui::PushItemWidth(250.0f * uiScale());
  Box next = box.box;
  if (drawCorner("from", next.min, step) | drawCorner("to", next.max, step)) {
    box.box.min = glm::min(next.min, next.max);
    box.box.max = glm::max(next.min, next.max);
    changed = true;
  }
  ImGui::PopItemWidth();
  return changed || remove;
}

}  // namespace

bool drawClipSection(ClipTool& tool, const View& view, const Box& bounds) {
  bool changed = false;
  if (tool.boxes().size() < Clip::kMost) {
    if (ImGui::SmallButton("new clip box")) changed = tool.add(boxInView(view, bounds));
  } else {
    ImGui::TextDisabled("at most %zu boxes", Clip::kMost);
  }
  for (std::size_t i = 0; i < tool.boxes().size(); ++i) {
    ImGui::PushID(static_cast<int>(2000 + i));
    bool remove = false;
    changed = drawBox(tool.boxes()[i], remove) || changed;
    ImGui::PopID();
    if (remove) tool.remove(i--);
  }
  if (!tool.boxes().empty()) ImGui::TextDisabled("drag the dots: a face, or the middle");
  return changed;
}

bool drawClassSection(const std::bitset<256>& present, std::bitset<256>& shown) {
  if (present.none()) {
    ImGui::TextDisabled("the points have no classes");
    return false;
  }
  bool changed = false;
  if (ImGui::SmallButton("all")) {
    shown.set();
    changed = true;
  }
  ImGui::SameLine();
  if (ImGui::SmallButton("none")) {
    shown &= ~present;
    changed = true;
  }
  for (std::size_t c = 0; c < present.size(); ++c) {
    if (!present[c]) continue;
    ImGui::PushID(static_cast<int>(3000 + c));
    bool on = shown[c];
    if (ImGui::Checkbox("##shown", &on)) {
      shown[c] = on;
      changed = true;
    }
    noteItem("class " + std::to_string(c));
    ImGui::SameLine();
    const std::uint32_t colour = classificationColour(static_cast<std::uint8_t>(c));
    ImGui::ColorButton("##colour", ImGui::ColorConvertU32ToFloat4(colour),
                       ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop,
                       ImVec2(14.0f * uiScale(), ImGui::GetFrameHeight()));
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::Text("%zu %s", c, className(static_cast<std::uint8_t>(c)).c_str());
    ImGui::SameLine();
    ImGui::SetCursorPosX(240.0f * uiScale());
    if (ImGui::SmallButton("only")) {
      shown.reset();
      shown.set(c);
      changed = true;
    }
    noteItem("only class " + std::to_string(c));
    ImGui::PopID();
  }
  return changed;
}

void drawClipBoxes(const ClipTool& tool, const View& view) {
  for (std::size_t i = 0; i < tool.boxes().size(); ++i) {
    const ClipBox& box = tool.boxes()[i];
    if (!box.on) continue;
    const std::uint32_t colour = box.cutout ? kCutoutColour : kBoxColour;
    for (const auto& [a, b] : edgesOf(box.box)) overlayLine(view, a, b, colour, 1.5f);
    for (int h = 0; h < kClipHandles; ++h) {
      const auto handle = static_cast<ClipHandle>(h);
      const bool held = tool.held() && *tool.held() == ClipTool::Grip{i, handle};
      overlayDot(view, handlePlace(box.box, handle), held ? kHeldColour : colour,
                 handle == ClipHandle::centre ? kHandlePx + 2.0f : kHandlePx);
    }
  }
}

}  // namespace strata
