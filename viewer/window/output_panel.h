#pragma once
#include <optional>
#include <string>

#include "core/view.h"
#include "viewer/camera/path_recorder.h"

namespace strata {

/// What the window for pictures and camera paths shows and changes.
struct OutputState {
  bool open = false;
  std::string pictureFile = "picture.png";
  int pictureWidth = 4096, pictureHeight = 2560;
  bool scalePoints = true;  ///< points cover as much of the picture as of the screen
  PathRecorder path;
  std::string pathFile = "flight.path.json";
  std::string filmFile = "flight.mp4";
  int filmWidth = 1920, filmHeight = 1080;
  double fps = 30.0;
  PathSpeed speed = PathSpeed::keyed;
  bool playing = false;
  std::string benchCommand;  ///< that plays the saved path
};

/// What the user asked for in it, for the app to do.
struct OutputRequest {
  bool takePicture = false, takeFilm = false;
  bool savePath = false, openPath = false;
  bool play = false;    ///< or stop playing
  bool record = false;  ///< or stop recording
  std::optional<View> goTo;
};

/// The window "Pictures and paths", where it is open; between Window::beginFrame() and finishFrame().
OutputRequest drawOutputPanel(OutputState& state, const View& view);

/// What is being drawn into a file, how far that is and how long it will take. True when the user would rather not.
bool drawWorkProgress(const std::string& what, double share, double seconds);

}  // namespace strata
