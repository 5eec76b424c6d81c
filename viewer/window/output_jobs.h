#pragma once
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "viewer/camera/camera_control.h"
#include "viewer/camera/camera_path.h"
#include "viewer/output/film_taker.h"
#include "viewer/output/picture_taker.h"
#include "viewer/window/messages.h"
#include "viewer/window/output_panel.h"
#include "viewer/window/window.h"

namespace strata {

/// The layers and options that pictures and films are drawn with: those of the picture on the screen.
struct OutputSource {
  Layers& layers;
  Rasterizer& rasterizer;
  const DrawOptions& draw;
  const SelectionOptions& selection;
  const std::string& firstStore;  ///< path
};

/// The camera path that is being made, recorded or played, and the picture or film that is being drawn. One of the
/// latter at a time: it has the layers and the rasterizer to itself. For the render thread.
class OutputJobs {
 public:
  /// Files are called `name`.png, .path.json and .mp4 until the user names them. Says in `messages` what was done and
  /// what went wrong.
  OutputJobs(const std::string& name, Messages& messages);

  // Once in each frame in which nothing is being drawn into a file.

  /// Carries out the commands of the keys, and moves the camera along the path that is being played.
  void use(const WindowInput& input, CameraControl& camera, const OutputSource& source);
  /// Draws the panel and carries out what is asked for in it. The view to which the camera is to go, if any.
  std::optional<View> drawPanel(const View& view, const OutputSource& source);

  /// True while a picture or a film is being drawn: the layers and the rasterizer are in use.
  bool drawing() const { return !std::holds_alternative<std::monostate>(work_); }
  /// Draws a little more of the picture or film, and shows the progress. Ends the job when `cancel` is set or the user
  /// asks for it.
  void goOn(const OutputSource& source, bool cancel);

  /// The path for the project; nothing where it has no keys.
  std::optional<CameraPath> path(const View& view) const;
  void setPath(const CameraPath& path);
  /// Writes the path as JSON, for strata-bench.
  void savePath(const View& view, const OutputSource& source);

  const OutputState& state() const { return state_; }
  bool busy() const { return state_.playing || state_.path.recording() || drawing(); }

 private:
  template <class Start>
  void start(const std::string& what, Start start);
  void startPicture(const View& view, const OutputSource& source);
  void startFilm(const View& view, const OutputSource& source);
  CameraPath pathOf(const View& view) const;
  void openPath();
  void toggleRecording(const View& view);
  void togglePlaying();
  /// The view `seconds` after the last frame; nothing where no path is being played.
  std::optional<View> play(const View& view, double seconds);

  Messages& messages_;
  OutputState state_;
  std::variant<std::monostate, std::unique_ptr<PictureTaker>, std::unique_ptr<FilmTaker>> work_;
  std::string what_;  ///< the file that is being drawn and its size, for people
  std::chrono::steady_clock::time_point began_;
  double played_ = 0.0;  ///< seconds since the beginning of the path
};

}  // namespace strata
