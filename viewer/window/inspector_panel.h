#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "core/render_list.h"
#include "viewer/session/layers.h"
#include "viewer/tools/node_shapes.h"
#include "viewer/window/picture_texture.h"

namespace strata {

/// How the engine chooses, shown over the picture: cubes and contours of the drawn nodes, the coarse depth, and the
/// view that nodes were chosen for while it is held still. For the render thread, with the GL context current.
class InspectorPanel {
 public:
  static constexpr std::size_t kMostNodes = 1500;  ///< that are outlined

  explicit InspectorPanel(GlContext::GetProc getProc) : texture_(getProc) {}

  /// Draws the section of the panel that switches all this.
  void drawSection(std::size_t nodesDrawn);
  /// The view that nodes are to be chosen for: `view`, or the one in which the choice was frozen.
  const View& chosenFor(const View& view);
  /// Between Window::beginFrame() and finishFrame(). `list` is the one that was drawn.
  void drawOver(const Layers& layers, const RenderList& list, const View& view);

 private:
  void drawNodes(const Layers& layers, const RenderList& list, const View& view);
  void drawDepth(const Layers& layers);

  bool frozen_ = false, cubes_ = false, contours_ = false, depth_ = false;
  std::optional<View> held_;
  std::vector<std::unique_ptr<NodeFinder>> finders_;  ///< by store, made when they are first needed
  std::vector<float> depths_;
  Picture depthPicture_;
  PictureTexture texture_;
};

}  // namespace strata
