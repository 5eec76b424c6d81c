#pragma once
#include <optional>
#include <vector>

#include "core/render_list.h"
#include "viewer/session/layers.h"
#include "viewer/tools/node_shapes.h"
#include "viewer/window/picture_texture.h"

namespace strata {

/// Shows how nodes are selected: cubes and contours of the drawn nodes, the coarse depth, and the view that nodes were
/// selected for while that is frozen. For the render thread, with the window's context current.
class InspectorPanel {
 public:
  static constexpr std::size_t kMostNodes = 1500;  ///< that get an outline

  explicit InspectorPanel(GlContext::GetProc getProc) : texture_(getProc) {}

  /// Draws the section "Inside" of the settings panel, whose check boxes switch these displays.
  void drawSection(std::size_t nodesDrawn);
  /// The view that nodes are to be selected for: `view`, or the one in which the user froze the selection.
  const View& chosenFor(const View& view);
  /// Draws the outlines and the window "Coarse depth"; between Window::beginFrame() and finishFrame(). `list` is the
  /// list that the picture was drawn from.
  void drawOver(const Layers& layers, const RenderList& list, const View& view);

 private:
  void drawNodes(const Layers& layers, const RenderList& list, const View& view);
  void drawDepth(const Layers& layers);

  bool frozen_ = false, cubes_ = false, contours_ = false, depth_ = false;
  std::optional<View> held_;
  std::vector<float> depths_;
  Picture depthPicture_;
  PictureTexture texture_;
};

}  // namespace strata
