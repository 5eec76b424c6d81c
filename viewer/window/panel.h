#pragma once
#include <bitset>
#include <cstdint>
#include <functional>
#include <string>

#include "core/draw_options.h"
#include "lod/streamer.h"
#include "render/create_rasterizer.h"
#include "viewer/camera/camera_control.h"
#include "viewer/window/frame_history.h"

namespace strata {

/// What the user may change while looking.
struct ViewerSettings {
  SelectionOptions selection;
  DrawOptions draw;
  double fovY = 1.0;  ///< of the camera, radians
  Backend backend = Backend::automatic;
};

/// Ends of the sliders: what the scan holds.
struct ColourLimits {
  glm::vec2 intensity{0.0f, 65535.0f};
  glm::dvec2 elevation{0.0, 1.0};
  int levels = 1;            ///< of the deepest store
  std::bitset<256> classes;  ///< that were met
  DrawOptions automatic;     ///< whose ranges "auto" brings back
};

/// What the panel shows.
struct ViewerStats {
  std::string rasterizer;
  std::string layers;  ///< names of the stores
  std::uint64_t pointsInStores = 0;
  double frameMs = 0.0;  ///< smoothed
  DrawStats draw;
  StreamerStats streamer;
  FrameHistory history;
  std::size_t nodesDrawn = 0;
  std::uint32_t missingNodes = 0;
  bool complete = false;
  MoveMode mode = MoveMode::orbit;
  double flySpeed = 0.0;     ///< metres a second that the keys move
  bool flying = false;       ///< they do, or the mouse would
  bool progressive = false;  ///< the rasterizer shades plainly and counts no overdraw
  std::string error;         ///< stays until it is closed
  std::string notice;        ///< what was done last
};

/// All keys and buttons, in a window of its own; `open` turns false when it is closed.
void drawHelp(bool& open);

/// Shows `text` until the user closes it, which empties it.
void drawError(std::string& text);

/// A turning arc in the corner of the picture for as long as detail is missing.
void drawSpinner(const ViewerStats& stats);

/// The speed of the flight, at the lower edge of the picture, while there is one.
void drawFlySpeed(const ViewerStats& stats);

/// What is to be done next, at the upper edge of the picture; nothing where the text is empty.
void drawHint(const std::string& text);

/// Draws the panel; between Window::beginFrame() and finishFrame(). True when a setting was changed. `inside` draws one
/// more section.
bool drawPanel(ViewerSettings& settings, const ViewerStats& stats, const ColourLimits& limits,
               const std::function<void()>& inside);

}  // namespace strata
