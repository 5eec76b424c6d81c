#include "viewer/window/inspector_panel.h"

#include <imgui.h>

#include <algorithm>

#include "render/picture/colour_map.h"
#include "viewer/tools/clip_boxes.h"
#include "viewer/window/overlay.h"

namespace strata {
namespace {

constexpr std::uint32_t kHeldColour = 0xffffffffu;
constexpr float kDepthSide = 256.0f;  // pixels

}  // namespace

void InspectorPanel::drawSection(std::size_t nodesDrawn) {
  ImGui::Checkbox("freeze the choice of nodes", &frozen_);
  ImGui::Checkbox("node cubes, by level", &cubes_);
  ImGui::Checkbox("contours, by class", &contours_);
  if (contours_) {
    for (const auto& [kind, name] :
         {std::pair{ContourClass::linear, "linear"}, std::pair{ContourClass::planar, "planar"},
          std::pair{ContourClass::volumetric, "volumetric"}}) {
      NodeRecord record{};
      record.contourClass = static_cast<std::uint8_t>(kind);
      ImGui::SameLine(kind == ContourClass::linear ? 28.0f * uiScale() : 0.0f);
      if (kind == ContourClass::linear) ImGui::NewLine();
      ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(contourColour(record)), "%s", name);
    }
  }
  if ((cubes_ || contours_) && nodesDrawn > kMostNodes) ImGui::TextDisabled("%zu of %zu nodes", kMostNodes, nodesDrawn);
  ImGui::Checkbox("coarse depth", &depth_);
}

const View& InspectorPanel::chosenFor(const View& view) {
  if (!frozen_) held_.reset();
  if (frozen_ && !held_) held_ = view;
  return held_ ? *held_ : view;
}

void InspectorPanel::drawOver(const Layers& layers, const RenderList& list, const View& view) {
  if (cubes_ || contours_) drawNodes(layers, list, view);
  if (held_)
    for (const auto& [a, b] : frustumEdges(*held_, glm::distance(held_->eye, held_->target)))
      overlayLine(view, a, b, kHeldColour, 1.5f);
  if (depth_) drawDepth(layers);
}

void InspectorPanel::drawNodes(const Layers& layers, const RenderList& list, const View& view) {
  for (std::size_t i = 0; i < std::min(list.items.size(), kMostNodes); ++i) {
    const Store& store = *layers.stores()[layers.indexOfItem(i)];
    const NodeRecord& record = store.hierarchy().nodes[list.items[i].index];
    const NodeKey key{record.key};
    if (cubes_)
      for (const auto& [a, b] : edgesOf(nodeCube(key, store.info().rootCube())))
        overlayLine(view, a, b, levelColour(key.level()), 1.0f);
    if (contours_)
      for (const auto& [a, b] : contourEdges(record)) overlayLine(view, a, b, contourColour(record), 1.0f);
  }
}

void InspectorPanel::drawDepth(const Layers& layers) {
  layers.coarseDepth(depths_);
  drawCoarseDepth(depths_, depthPicture_);
  texture_.upload(depthPicture_);
  ImGui::SetNextWindowPos(ImVec2(0.5f * ImGui::GetIO().DisplaySize.x, 12.0f), ImGuiCond_FirstUseEver,
                          ImVec2(0.5f, 0.0f));
  if (ImGui::Begin("Coarse depth", &depth_, ImGuiWindowFlags_AlwaysAutoResize)) {
    ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture_.id())),
                 ImVec2(kDepthSide * uiScale(), kDepthSide * uiScale()));
    ImGui::TextDisabled("bright is near; what is dark hides nothing");
  }
  ImGui::End();
}

}  // namespace strata
