#pragma once
#include <cstdint>
#include <string>

#include "core/frame.h"
#include "lod/streamer.h"
#include "render/rasterizer.h"

namespace strata {

/// What the user may change while looking.
struct ViewerSettings {
  SelectionOptions selection;
  DrawOptions draw;
};

/// What the panel shows.
struct ViewerStats {
  std::string rasterizer;
  std::string layers;  ///< names of the stores
  std::uint64_t pointsInStores = 0;
  double frameMs = 0.0;  ///< smoothed
  DrawStats draw;
  StreamerStats streamer;
  std::uint32_t missingNodes = 0;
  bool complete = false;
  double flySpeed = 0.0;  ///< metres a second that the keys move
  std::string error;      ///< stays until it is closed
  std::string notice;     ///< what was done last
};

/// All keys and buttons, in a window of its own; `open` turns false when it is closed.
void drawHelp(bool& open);

/// Shows `text` until the user closes it, which empties it.
void drawError(std::string& text);

/// Draws the panel; between Window::beginFrame() and finishFrame(). True when a setting was changed.
bool drawPanel(ViewerSettings& settings, const ViewerStats& stats);

}  // namespace strata
