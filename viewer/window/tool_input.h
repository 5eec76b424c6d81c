#pragma once
#include <optional>
#include <string>

#include "core/picture.h"
#include "core/render_list.h"
#include "viewer/camera/camera_control.h"
#include "viewer/session/layers.h"
#include "viewer/window/point_lookup.h"
#include "viewer/window/tools_panel.h"
#include "viewer/window/window.h"

namespace strata {

/// What the user sees and means with the mouse.
struct ScreenContent {
  const Layers& layers;
  const RenderList* list;  ///< that the picture was drawn from; null before the first picture
  const Picture& picture;
  const Box& bounds;  ///< of the scan
};

/// Moves the camera and drags the handles of clip boxes as mouse and keys say. Once in each frame.
void steer(CameraControl& control, ToolsState& tools, const WindowInput& input, const ScreenContent& seen);

/// Picks, measures and makes clip boxes as clicks and keys say. For the render thread.
class ToolInput {
 public:
  /// Once in each frame. Returns what went wrong; empty where nothing did.
  std::string use(ToolsState& tools, const WindowInput& input, const View& view, const ScreenContent& seen);
  /// True while a clicked point is being read from the disk.
  bool busy() const { return lookup_.pending(); }

 private:
  PointLookup lookup_;
  bool endMeasuring_ = false;  ///< the measurement ends as soon as the points clicked so far have been read
};

}  // namespace strata
