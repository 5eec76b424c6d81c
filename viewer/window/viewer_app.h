#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/draw_options.h"
#include "lod/streamer.h"
#include "render/create_rasterizer.h"
#include "viewer/session/draw_flags.h"
#include "viewer/session/drawing.h"
#include "viewer/session/progressive_flags.h"

namespace strata {

/// The command line of strata-view.
struct ViewerOptions {
  std::vector<std::string> stores;
  std::string project;  ///< file; empty = none. Read where it exists, and saved to
  Backend backend = Backend::automatic;
  PictureSize size{1280, 800};
  StreamerOptions streamer;
  std::optional<ColourMode> colour;
  DrawFlags draw;
  ProgressiveFlags progressive;
  int pointSize = 2;
  bool edl = true;
  bool convert = false;  ///< scans are converted without asking
  std::string picture;   ///< file; draws the scene alone in full detail and ends
  PictureSize pictureSize{4096, 2560};
  std::string state;       ///< file that says after every frame what the window shows, for scripts; empty = none
  std::string screenshot;  ///< file; draws one frame in full detail, window and all, and ends
};

/// Nothing when help or the version was asked for and has been printed. Throws UsageError.
std::optional<ViewerOptions> parseViewerOptions(int argc, const char* const* argv);

/// Until the window is closed. Throws Error for stores that cannot be opened and where there is no window.
void runViewer(const ViewerOptions& options);

}  // namespace strata
