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
};

/// Draws the panel; between Window::beginFrame() and finishFrame(). True when a setting was changed.
bool drawPanel(ViewerSettings& settings, const ViewerStats& stats);

}  // namespace strata
