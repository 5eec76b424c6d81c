#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/draw_options.h"
#include "lod/streamer.h"
#include "render/create_rasterizer.h"
#include "viewer/session/draw_flags.h"
#include "viewer/session/picture_size.h"
#include "viewer/session/progressive_flags.h"

namespace strata {

/// The command line of strata-view.
struct ViewerOptions {
  std::vector<std::string> stores;  ///< paths; those of scans and of a project are replaced before the viewer starts
  std::string project;              ///< the file to which the project is saved; empty: one named after the first store
  Backend backend = Backend::automatic;
  PictureSize size{1280, 800};  ///< of the window
  StreamerOptions streamer;
  std::optional<ColourMode> colour;
  DrawFlags draw;
  ProgressiveFlags progressive;
  int pointSize = 2;  ///< pixels
  bool edl = true;
  bool convert = false;  ///< scans are converted without asking
  std::string picture;   ///< file; the program draws the scan without panels in full detail and ends
  PictureSize pictureSize{4096, 2560};
  std::string screenshot;  ///< file; the program draws one frame in full detail, window and all, and ends
  std::string state;       ///< file that tells scripts after every frame what the window shows; empty: none
};

/// Nothing when help or the version was asked for and has been printed. Throws UsageError.
std::optional<ViewerOptions> parseViewerOptions(int argc, const char* const* argv);

}  // namespace strata
