#pragma once
#include <optional>
#include <string>

#include "core/picture.h"
#include "core/render_list.h"
#include "viewer/camera/camera_control.h"
#include "viewer/session/layers.h"
#include "viewer/window/measure_panel.h"
#include "viewer/window/point_lookup.h"
#include "viewer/window/window.h"

namespace strata {

/// What is on the screen.
struct ScreenContent {
  const Layers& layers;
  const RenderList* list;  ///< that the picture was drawn from; null before the first
  const Picture& picture;
  const Box& bounds;  ///< of the scan
};

/// Camera and clip boxes, by mouse and keys; `seconds` of the input later.
void steer(CameraControl& control, ToolsState& tools, const WindowInput& input, const ScreenContent& seen);

/// Clicks and keys of picking, measuring and clipping. For the render thread.
class ToolInput {
 public:
  /// Once a frame. What went wrong; empty where nothing did.
  std::string use(ToolsState& tools, const WindowInput& input, const View& view, const ScreenContent& seen);
  /// The disk has been asked about a point and has not yet answered.
  bool busy() const { return lookup_.pending(); }

 private:
  PointLookup lookup_;
  bool endMeasuring_ = false;  ///< as soon as the points asked for are there
};

}  // namespace strata
