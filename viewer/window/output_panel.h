#pragma once
#include <optional>
#include <string>

#include "core/view.h"
#include "viewer/camera/path_recorder.h"

namespace strata {

/// What the panel "Pictures and paths" shows and changes.
struct OutputState {
  bool open = false;
  std::string pictureFile;
  int pictureWidth = 4096, pictureHeight = 2560;
  bool scalePoints = true;  ///< points cover the same share of the picture as of the screen
  PathRecorder path;
  std::string pathFile;
  std::string filmFile;
  int filmWidth = 1920, filmHeight = 1080;
  double fps = 30.0;
  PathSpeed speed = PathSpeed::keyed;
  bool playing = false;
  std::string benchCommand;  ///< plays the path that was saved last
};

/// What the user asked for in the panel; OutputJobs does it.
struct OutputRequest {
  bool takePicture = false, takeFilm = false;
  bool savePath = false, openPath = false;
  bool play = false;         ///< or stop playing
  bool record = false;       ///< or stop recording
  std::optional<View> goTo;  ///< the view of a key
};

/// Draws the panel where it is open; between Window::beginFrame() and finishFrame().
OutputRequest drawOutputPanel(OutputState& state, const View& view);

/// Draws how far the work on `what` is, as a share from 0 to 1, and after a few of its `seconds` how long the rest will
/// take. True when the user wants to give up.
bool drawWorkProgress(const std::string& what, double share, double seconds);

}  // namespace strata
