#pragma once
#include <bitset>
#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "core/draw_options.h"
#include "lod/selection.h"
#include "render/create_rasterizer.h"
#include "viewer/camera/camera_control.h"
#include "viewer/window/inspector_panel.h"
#include "viewer/window/layer_renderer.h"

namespace strata {

/// What the user may change about how the scan is drawn.
struct ViewerSettings {
  SelectionOptions selection;
  DrawOptions draw;
  double fovY = 1.0;  ///< of the camera, radians
  Backend backend = Backend::automatic;
};

/// The ends of the panel's sliders, which follow from what the scan holds.
struct ColourLimits {
  glm::vec2 intensity{0.0f, 65535.0f};
  glm::dvec2 elevation{0.0, 1.0};
  int levels = 1;            ///< of the deepest store
  std::bitset<256> classes;  ///< those met so far
  DrawOptions automatic;     ///< the button "auto" brings its ranges back
};

/// What the panel tells.
struct SettingsPanelFacts {
  const std::string& layers;  ///< names of the stores
  std::uint64_t pointsInStores;
  const std::string& rasterizer;  ///< name and device
  bool progressive;               ///< the rasterizer shades plainly and counts no overdraw
  const FrameReport& frame;
  MoveMode mode;
  double flySpeed;  ///< metres per second
  const std::string& notice;
};

/// Draws the panel "Strata" at the left edge: the sections "Look", "Speed" and "Inside", the last of which `inspector`
/// draws. Between Window::beginFrame() and finishFrame(). True when a setting was changed.
bool drawSettingsPanel(ViewerSettings& settings, const ColourLimits& limits, const SettingsPanelFacts& facts,
                       InspectorPanel& inspector);

}  // namespace strata
